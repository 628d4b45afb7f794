// The light that reaches the ground under a storm, which lights the storm from below. It consists
// of sunlight through the storm's shadow, skylight past the storm, and light that the storm's faces
// reflect. The ground in the picture receives the same light (post/composite.frag). The class owns
// GL objects, so use it on the context's thread.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "renderers/ground.h"
#include "renderers/lit_ground.h"
#include "renderers/render_settings.h"
#include "renderers/sky_and_ground.h"
#include "volume/visible_box.h"

namespace thunderhead::renderers {

class GroundLight {
 public:
  explicit GroundLight(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)) {}

  // Computes the light around `storm`. The storm's shadow must have been set in `ground`, and the
  // share of the sky that the storm hides must have been computed (SkyAndGround::HideSky). If the
  // storm's box with a margin of the storm's height is wider than 384 km, the function returns the
  // light of open ground.
  absl::StatusOr<LitGround> Find(const Ground& ground, const SkyAndGround& surroundings,
                                 const volume::WorldBox& storm, const Illumination& light);

  std::size_t Bytes() const { return map_.Bytes(); }

 private:
  std::shared_ptr<gl::ProgramCache> programs_;
  gl::Texture3D map_;  // has one layer
};

}  // namespace thunderhead::renderers
