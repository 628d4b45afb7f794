#include "frame/pixel_reader.h"

#include <algorithm>

#include "gl/device.h"

namespace thunderhead::frame {
namespace {

constexpr std::size_t kChannels = 3;
constexpr GLbitfield kMapped = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

}  // namespace

std::vector<std::uint8_t> PixelReader::Rgb(const gl::Texture2D& texture) {
  const std::size_t bytes = static_cast<std::size_t>(texture.Size().x) *
                            static_cast<std::size_t>(texture.Size().y) * kChannels;
  std::vector<std::uint8_t> rgb(bytes);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  if (gl::DrawsInSoftware()) {
    glGetTextureImage(texture.Get(), 0, GL_RGB, GL_UNSIGNED_BYTE, static_cast<GLsizei>(bytes),
                      rgb.data());
    return rgb;
  }
  if (buffer_.Bytes() < bytes) {
    buffer_ = gl::Buffer(bytes, nullptr, kMapped | GL_CLIENT_STORAGE_BIT);
    mapped_ = static_cast<const std::uint8_t*>(
        glMapNamedBufferRange(buffer_.Get(), 0, static_cast<GLsizeiptr>(bytes), kMapped));
  }
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.Get());
  glGetTextureImage(texture.Get(), 0, GL_RGB, GL_UNSIGNED_BYTE, static_cast<GLsizei>(bytes),
                    nullptr);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glFinish();
  std::copy_n(mapped_, bytes, rgb.begin());
  return rgb;
}

}  // namespace thunderhead::frame
