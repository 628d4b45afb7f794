// Encodes and decodes JPEG (libjpeg-turbo) and PNG (libpng). Pixels are 8-bit sRGB, three bytes
// each, rows from top to bottom. The encoders return INVALID_ARGUMENT for a side outside 1 to 65535
// pixels, a wrong number of bytes or a JPEG quality outside 1 to 100. The decoders return
// INVALID_ARGUMENT for bytes that are not a whole picture. The functions are pure and safe to call
// from any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"

namespace thunderhead::frame {

struct RgbImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> rgb;
};

// Encodes a JPEG with 4:2:0 chroma. `quality` is 1 to 100. Several threads encode a large picture.
absl::StatusOr<std::string> EncodeJpeg(int width_px, int height_px,
                                       absl::Span<const std::uint8_t> rgb, int quality);

absl::StatusOr<std::string> EncodePng(int width_px, int height_px,
                                      absl::Span<const std::uint8_t> rgb);

absl::StatusOr<RgbImage> DecodePng(const std::string& png);

absl::StatusOr<RgbImage> DecodeJpeg(const std::string& jpeg);

}  // namespace thunderhead::frame
