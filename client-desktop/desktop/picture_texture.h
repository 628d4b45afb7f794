// The newest picture, as a texture that the interface can draw.
#pragma once

#include <imgui.h>

#include <cstdint>

#include "thunderhead_client/picture_decoder.h"

namespace thunderhead::desktop {

class PictureTexture {
 public:
  PictureTexture() = default;
  ~PictureTexture();
  PictureTexture(const PictureTexture&) = delete;
  PictureTexture& operator=(const PictureTexture&) = delete;

  // Uploads the pixels. This and the destructor require the window's OpenGL context.
  void Upload(const client::Pixels& pixels);
  bool empty() const { return texture_ == 0; }
  // Dear ImGui keeps the number of an OpenGL texture in a pointer.
  ImTextureID id() const {
    // NOLINTNEXTLINE(performance-no-int-to-ptr)
    return reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(texture_));
  }
  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }

 private:
  unsigned texture_ = 0;
  int width_px_ = 0;
  int height_px_ = 0;
};

}  // namespace thunderhead::desktop
