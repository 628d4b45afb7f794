// The phase functions of a medium's groups for shaders/common/phase.glsl. Phase functions given by
// formulas and those given by tables are both stored as sampled curves, one texture row for each
// group. This code does not use a renderer.
#pragma once

#include <vector>

#include "gl/objects.h"
#include "physics/hydrometeors.h"

namespace thunderhead::renderers {

class PhaseCurves {
 public:
  PhaseCurves() = default;
  // Creates one row for each of `phases`, which must not be empty.
  explicit PhaseCurves(const std::vector<physics::PhaseFunction>& phases);

  // Binds the texture to the unit that common/phase.glsl names.
  void Bind() const;
  std::size_t Bytes() const { return texture_.Bytes(); }

 private:
  gl::Texture2D texture_;
};

}  // namespace thunderhead::renderers
