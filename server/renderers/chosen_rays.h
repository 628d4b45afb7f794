// Rays of chosen places in a picture, packed as the pixels of a small target. Blocks of four by two
// pixels, which software GL draws together, hold neighbours of the list. The class owns GL objects,
// so use it on the context's thread.
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
  // Chooses the rays of all pixels of a picture, in blocks of neighbours (post/unpacked.frag). A
  // small picture would lie in only a few of the tiles of 64 x 64 that software GL distributes to
  // its threads.
  void ChooseAll(const glm::ivec2& size_px);

  // Returns the pixel for the ray of the place with that index, in a target of Size().
  static glm::ivec2 PixelOf(std::size_t index);
  // Returns the size of targets. It only grows, so that targets are not recreated for each picture.
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
