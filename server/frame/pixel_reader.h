// Reads finished pictures back.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "gl/objects.h"
#include "gl/pieces.h"

namespace thunderhead::frame {

// From a GPU through a buffer that stays mapped, which takes a third of the time that reading to
// the program's memory takes (docs/performance.md, "On a GPU"). Used by the thread of its context
// alone.
class PixelReader {
 public:
  // Three bytes a pixel, rows as in `texture`; waits for what draws it. Some rows in each piece.
  absl::StatusOr<std::vector<std::uint8_t>> Rgb(const gl::Texture2D& texture, gl::Pieces& pieces);

 private:
  gl::Buffer buffer_;
  const std::uint8_t* mapped_ = nullptr;
};

}  // namespace thunderhead::frame
