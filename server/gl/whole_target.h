// Draws all pixels of a target by a program whose vertices come from common/whole_target.vert.
#pragma once

#include "gl/objects.h"
#include "gl/program.h"

namespace thunderhead::gl {

class WholeTarget {
 public:
  // Textures, uniforms, and what limits the drawing are the caller's.
  void Draw(const Program& program, const Framebuffer& target) const {
    target.Bind();
    program.Use();
    no_attributes_.Bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

 private:
  VertexArray no_attributes_ = VertexArray::Empty();
};

}  // namespace thunderhead::gl
