// The phase functions of a medium's groups as shaders/common/phase.glsl looks them up: formulas and
// tables alike, a row a group. Knows no renderer.
#pragma once

#include <vector>

#include "gl/objects.h"
#include "physics/hydrometeors.h"

namespace thunderhead::renderers {

class PhaseCurves {
 public:
  PhaseCurves() = default;
  // One row for each of `phases`, at least one.
  explicit PhaseCurves(const std::vector<physics::PhaseFunction>& phases);

  // Binds the texture to the unit that common/phase.glsl names.
  void Bind() const;
  std::size_t Bytes() const { return texture_.Bytes(); }

 private:
  gl::Texture2D texture_;
};

}  // namespace thunderhead::renderers
