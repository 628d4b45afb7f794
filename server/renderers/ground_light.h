// The light that reaches the ground under a storm, for what lights the storm from below: sunlight
// through the storm's shadow, skylight past it and what the storm's faces reflect, as the picture
// of the ground has them (post/composite.frag). Owns GL objects: use it on the context's thread.
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

  // Around `storm`, whose shadow `ground` has and whose share of the sky `surroundings` know. Open
  // ground's, around more than some 380 km.
  absl::StatusOr<LitGround> Find(const Ground& ground, const SkyAndGround& surroundings,
                                 const volume::WorldBox& storm, const Illumination& light);

  std::size_t Bytes() const { return map_.Bytes(); }

 private:
  std::shared_ptr<gl::ProgramCache> programs_;
  gl::Texture3D map_;  // one layer
};

}  // namespace thunderhead::renderers
