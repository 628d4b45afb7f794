#include "desktop/picture_texture.h"

#include <GL/gl.h>
#include <GL/glext.h>

namespace thunderhead::desktop {

PictureTexture::~PictureTexture() {
  if (texture_ != 0) glDeleteTextures(1, &texture_);
}

void PictureTexture::Upload(const client::Pixels& pixels) {
  if (texture_ == 0) {
    glGenTextures(1, &texture_);
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  const bool same_size = pixels.width_px == width_px_ && pixels.height_px == height_px_;
  if (same_size) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_px_, height_px_, GL_RGBA, GL_UNSIGNED_BYTE,
                    pixels.rgbx.data());
    return;
  }
  width_px_ = pixels.width_px;
  height_px_ = pixels.height_px;
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width_px_, height_px_, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               pixels.rgbx.data());
}

}  // namespace thunderhead::desktop
