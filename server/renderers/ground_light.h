// The light that reaches the ground under a storm, for what lights the storm from below: sunlight
// through the storm's shadow and skylight past it, as the picture of the ground has them
// (post/composite.frag). Owns GL objects: use it on the context's thread.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "renderers/ground.h"
#include "renderers/lit_ground.h"
#include "renderers/sky_and_ground.h"
#include "volume/visible_box.h"

namespace thunderhead::renderers {

class GroundLight {
 public:
  explicit GroundLight(std::shared_ptr<gl::ProgramCache> programs)
      : programs_(std::move(programs)) {}

  // Around `storm`, whose shadow `ground` has and whose share of the sky `surroundings` know.
  // `sunlit` is the share of sunlight in the light that open ground receives, `albedo` the ground's
  // on average.
  absl::StatusOr<LitGround> Find(const Ground& ground, const SkyAndGround& surroundings,
                                 const volume::WorldBox& storm, float sunlit, float albedo);

  std::size_t Bytes() const { return map_.Bytes(); }

 private:
  std::shared_ptr<gl::ProgramCache> programs_;
  gl::Texture3D map_;  // one layer
};

}  // namespace thunderhead::renderers
