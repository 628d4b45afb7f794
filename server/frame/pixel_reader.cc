#include "frame/pixel_reader.h"

#include <algorithm>

#include "base/status.h"
#include "gl/device.h"
#include "gl/device_faults.h"

namespace thunderhead::frame {
namespace {

constexpr std::size_t kChannels = 3;
constexpr double kPixel_ns = 1.0;
constexpr GLbitfield kMapped = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

}  // namespace

absl::StatusOr<std::vector<std::uint8_t>> PixelReader::Rgb(const gl::Texture2D& texture,
                                                           gl::Pieces& pieces) {
  const glm::ivec2 size = texture.Size();
  const std::size_t row_bytes = static_cast<std::size_t>(size.x) * kChannels;
  const std::size_t bytes = row_bytes * static_cast<std::size_t>(size.y);
  std::vector<std::uint8_t> rgb(bytes);
  const bool by_buffer = !gl::DrawsInSoftware();
  if (by_buffer && buffer_.Bytes() < bytes) {
    buffer_ = gl::Buffer(bytes, nullptr, kMapped | GL_CLIENT_STORAGE_BIT);
    mapped_ = static_cast<const std::uint8_t*>(
        glMapNamedBufferRange(buffer_.Get(), 0, static_cast<GLsizeiptr>(bytes), kMapped));
    if (mapped_ == nullptr) {
      buffer_ = gl::Buffer();
      return gl::OutOfDeviceMemory();
    }
  }
  const auto read = [&](int begin, int end) {
    const std::size_t offset = row_bytes * static_cast<std::size_t>(begin);
    const std::size_t count = row_bytes * static_cast<std::size_t>(end - begin);
    if (by_buffer) glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.Get());
    // If a pixel buffer is bound, GL takes the pointer argument as an offset into the buffer.
    void* const to = by_buffer
                         ? reinterpret_cast<void*>(offset)  // NOLINT(performance-no-int-to-ptr)
                         : rgb.data() + offset;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureSubImage(texture.Get(), 0, 0, begin, 0, size.x, end - begin, 1, GL_RGB,
                         GL_UNSIGNED_BYTE, static_cast<GLsizei>(count), to);
    if (!by_buffer) return;
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glFinish();
    std::copy_n(mapped_ + offset, count, rgb.begin() + static_cast<std::ptrdiff_t>(offset));
  };
  THUNDERHEAD_RETURN_IF_ERROR(pieces.Steps({"read back", kPixel_ns * size.x}, size.y, read));
  return rgb;
}

}  // namespace thunderhead::frame
