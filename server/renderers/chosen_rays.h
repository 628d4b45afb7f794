// Rays through chosen places of a picture, packed as the pixels of a small render target.
// Consecutive places lie in blocks of four by two pixels, because software GL draws such a block
// together. The class owns GL objects, so use it on the context's thread.
#pragma once

#include <cstddef>
#include <vector>

#include "gl/objects.h"
#include "gl/pixel_rect.h"
#include "glm/vec2.hpp"

namespace thunderhead::renderers {

class ChosenRays {
 public:
  // Sets the rays' places, in the coordinates of common/ray_place.glsl.
  void Choose(const std::vector<glm::vec2>& places);
  // Chooses the rays of all pixels of a picture, in blocks of neighbouring pixels
  // (post/unpacked.frag). Packing spreads the rays over the target. Software GL distributes tiles
  // of 64 x 64 pixels to its threads, and a small picture would occupy only a few of them.
  void ChooseAll(const glm::ivec2& size_px);

  // Returns the target pixel of the ray through place number `index`. The target has the size
  // Size().
  static glm::ivec2 PixelOf(std::size_t index);
  // Returns the size of render targets for these rays. It never shrinks, so that targets are not
  // recreated for each picture.
  glm::ivec2 Size() const { return places_.Size(); }
  // Returns the part of the target that holds rays.
  gl::PixelRect Rect() const { return rect_; }
  void Bind() const;
  std::size_t Bytes() const { return places_.Bytes(); }

 private:
  gl::Texture2D places_;
  gl::PixelRect rect_;
  std::vector<glm::vec2> texels_;
};

}  // namespace thunderhead::renderers
