// Reads finished pictures back from the device.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/pieces.h"

namespace thunderhead::frame {

// Reads pixels. From a GPU it reads through a persistently mapped buffer, which takes a third of
// the time of reading to the program's memory (docs/performance.md, "On a GPU"). Only the thread of
// the reader's GL context may use it.
class PixelReader {
 public:
  // Returns three bytes a pixel, with rows in the order of `texture`. It waits for pending drawing
  // to the texture, and reads some rows in each piece (gl/pieces.h). Returns RESOURCE_EXHAUSTED if
  // the device has no memory for the buffer.
  absl::StatusOr<std::vector<std::uint8_t>> Rgb(const gl::Texture2D& texture, gl::Pieces& pieces);

 private:
  gl::Buffer buffer_;
  const std::uint8_t* mapped_ = nullptr;
};

}  // namespace thunderhead::frame
