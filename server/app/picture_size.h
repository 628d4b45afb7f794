// A picture's size as flags give it.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::app {

struct PictureSize {
  int width_px = 0;
  int height_px = 0;
};

// Of `size`, WIDTHxHEIGHT; INVALID_ARGUMENT names the flag --size.
absl::StatusOr<PictureSize> ParsePictureSize(const std::string& size);

}  // namespace thunderhead::app
