// The variants of the cumulus shaders.
#pragma once

#include "gl/program.h"

namespace thunderhead::renderers {

// Variant of cumulus/bubble.vert with cumulus/depth.frag.
struct BubbleVariant {
  gl::DefineValue base;         // the surface is cut off at a height
  gl::DefineValue ground;       // ground may hide bubbles
  gl::DefineValue front_first;  // bubbles are drawn front to back

  gl::Defines Defines() const {
    return {{"BASE", base}, {"GROUND", ground}, {"FRONT_FIRST", front_first}};
  }
};

// Variant of cumulus/bubble.vert with cumulus/shade.frag.
struct ShadeVariant {
  BubbleVariant bubble;
  gl::DefineValue plain;  // only Lambert's law

  gl::Defines Defines() const { return gl::Joined(bubble.Defines(), {{"PLAIN", plain}}); }
};

}  // namespace thunderhead::renderers
