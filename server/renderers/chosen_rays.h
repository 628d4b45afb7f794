// Rays of chosen places in a picture, one beside the other as the pixels of a small target: blocks
// of four by two, which software GL draws together, hold neighbours of the list. Owns GL objects:
// use it on the context's thread.
#pragma once

#include <cstddef>
#include <vector>

#include "gl/objects.h"
#include "gl/pixel_rect.h"
#include "glm/vec2.hpp"

namespace thunderhead::renderers {

class ChosenRays {
 public:
  // Places as common/ray_place.glsl has them.
  void Choose(const std::vector<glm::vec2>& places);
  // The rays of all pixels of a picture, in blocks of neighbours (post/unpacked.frag): a small
  // picture itself lies in few of the tiles of 64 x 64 that software GL deals out to its threads.
  void ChooseAll(const glm::ivec2& size_px);

  // Where the ray of the place of that index is drawn, in a target of Size().
  static glm::ivec2 PixelOf(std::size_t index);
  // The size of targets: it only grows, so that these are not made anew for each picture.
  glm::ivec2 Size() const { return places_.Size(); }
  // The part of it that rays are in.
  gl::PixelRect Rect() const { return rect_; }
  void Bind() const;
  std::size_t Bytes() const { return places_.Bytes(); }

 private:
  gl::Texture2D places_;
  gl::PixelRect rect_;
  std::vector<glm::vec2> texels_;
};

}  // namespace thunderhead::renderers
