// Encodes and decodes AVIF pictures by libavif. They have 10 bits per channel and no chroma
// subsampling, so that a clear sky shows no banding. The functions are pure and safe to call from
// any thread.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "frame/fine_image.h"

namespace thunderhead::codec {

struct AvifOptions {
  int quantizer = 8;  // 0 (lossless) to 63
  int speed = 9;      // speed of the encoder, 0 (slowest) to 10
};

absl::StatusOr<std::string> EncodeAvif(const frame::FineImage& image,
                                       const AvifOptions& options = {});

// Decodes an AVIF for tests and measurements. Clients have their own decoder. Returns
// INVALID_ARGUMENT for bytes that are not an AVIF.
absl::StatusOr<frame::FineImage> DecodeAvif(const std::string& avif);

}  // namespace thunderhead::codec
