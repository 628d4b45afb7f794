// The flag --size.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::app {

struct PictureSize {
  int width_px = 0;
  int height_px = 0;
};

// Parses WIDTHxHEIGHT. INVALID_ARGUMENT names `flag`.
absl::StatusOr<PictureSize> ParsePictureSize(const std::string& size,
                                             const std::string& flag = "--size");

}  // namespace thunderhead::app
