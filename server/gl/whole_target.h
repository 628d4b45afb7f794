// Draws every pixel of a render target (a whole target), by rasterization or by a compute shader.
// The program's source must be made by ProgramSource::WholeTarget or BlendedWholeTarget.
#pragma once

#include "absl/status/status.h"
#include "gl/objects.h"
#include "gl/pieces.h"
#include "gl/program.h"

namespace thunderhead::gl {

// Returns true if the thread's device draws whole targets faster by compute shaders than by
// rasterization. The speed is measured once for each kind of device in a process. Software GL
// always rasterizes. The environment variable THUNDERHEAD_WHOLE_TARGETS overrides the measurement
// with the value "raster" or "compute".
bool ComputesWholeTargets();

class WholeTarget {
 public:
  // Draws the whole target in tiles. The caller sets textures and uniforms. To draw only some
  // pixels, the caller enables a depth test of the target against 0.5 (GL_DEPTH_TEST with GL_LESS
  // or GL_GREATER).
  absl::Status Draw(Pieces& pieces, const PieceCost& pixel, const Program& program,
                    const Framebuffer& target) const {
    return Draw(pieces, pixel, program, target, {glm::ivec2(0), target.Size()});
  }
  // Draws only the pixels in `rect`.
  absl::Status Draw(Pieces& pieces, const PieceCost& pixel, const Program& program,
                    const Framebuffer& target, const PixelRect& rect) const;

 private:
  static void Compute(const Program& program, const Framebuffer& target);

  VertexArray no_attributes_ = VertexArray::Empty();
};

}  // namespace thunderhead::gl
