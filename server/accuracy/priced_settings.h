// Costs and errors of settings, read from the tables of `thunderhead measure trade`. Columns are
// read by name. A table with an unknown column is refused, because rows that differ only in this
// column would look the same.
#pragma once

#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/setting.h"
#include "glm/vec2.hpp"

namespace thunderhead::accuracy {

struct PricedSetting {
  Setting setting;
  double milliseconds = 0.0;   // time of a frame after the camera has moved, for a picture of the
                               // table's size
  double relative_rmse = 0.0;  // relative RMSE of linear radiance, compared with the reference
};

struct PricedSettings {
  glm::ivec2 size_px{0};
  // The rows with the table's most frequent JPEG quality. Rows that differ only in this quality are
  // left out, because it changes the bytes but not the radiance.
  std::vector<PricedSetting> rows;
};

// Reads a table. Returns INVALID_ARGUMENT, with the line and the missing, unknown or non-numeric
// value, if the table is invalid.
absl::StatusOr<PricedSettings> ReadPricedSettings(std::string_view text);

}  // namespace thunderhead::accuracy
