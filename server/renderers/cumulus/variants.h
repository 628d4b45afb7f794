// The variants of the cumulus shaders.
#pragma once

#include "gl/program.h"

namespace thunderhead::renderers {

// Preprocessor variant of cumulus/bubble.vert with cumulus/depth.frag.
struct BubbleVariant {
  gl::DefineValue base;         // 1 if the surface is cut off at a base height
  gl::DefineValue ground;       // 1 if ground may hide bubbles
  gl::DefineValue front_first;  // 1 if bubbles are drawn front to back

  gl::Defines Defines() const {
    return {{"BASE", base}, {"GROUND", ground}, {"FRONT_FIRST", front_first}};
  }
};

// Preprocessor variant of cumulus/bubble.vert with cumulus/shade.frag.
struct ShadeVariant {
  BubbleVariant bubble;
  gl::DefineValue plain;  // 1 for shading by Lambert's law only

  gl::Defines Defines() const { return gl::Joined(bubble.Defines(), {{"PLAIN", plain}}); }
};

}  // namespace thunderhead::renderers
