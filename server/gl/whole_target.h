// Draws all pixels of a target by a program whose source is ProgramSource::WholeTarget.
#pragma once

#include "gl/objects.h"
#include "gl/program.h"

namespace thunderhead::gl {

// Whether the thread's device draws whole targets faster by compute shaders; measured once a
// process. Software GL always rasterizes. THUNDERHEAD_WHOLE_TARGETS=raster or compute in the
// environment decides instead.
bool ComputesWholeTargets();

class WholeTarget {
 public:
  // Textures and uniforms are the caller's, and what limits the drawing: a rectangle
  // (GL_SCISSOR_TEST), or the target's depth, which is tested against 0.5 (GL_DEPTH_TEST with
  // GL_LESS or GL_GREATER).
  void Draw(const Program& program, const Framebuffer& target) const;

 private:
  static void Compute(const Program& program, const Framebuffer& target);

  VertexArray no_attributes_ = VertexArray::Empty();
};

}  // namespace thunderhead::gl
