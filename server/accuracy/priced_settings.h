// Costs and errors of settings, read from the tables of `thunderhead measure trade`. Columns are
// read by name. A table with an unknown column is refused, because the column might distinguish
// rows that would be taken for the same. Pure functions.
#pragma once

#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/setting.h"
#include "glm/vec2.hpp"

namespace thunderhead::accuracy {

struct PricedSetting {
  Setting setting;
  double milliseconds = 0.0;   // time of a frame of a moved camera, at the table's size
  double relative_rmse = 0.0;  // of linear radiance, against the reference
};

struct PricedSettings {
  glm::ivec2 size_px{0};
  // Rows with the table's most frequent JPEG quality, which changes bytes but not the radiance.
  std::vector<PricedSetting> rows;
};

// INVALID_ARGUMENT names the missing, unknown or non-numeric value and its line.
absl::StatusOr<PricedSettings> ReadPricedSettings(std::string_view text);

}  // namespace thunderhead::accuracy
