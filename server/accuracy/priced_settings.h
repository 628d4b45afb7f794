// Costs and errors of settings as `thunderhead measure trade` found them: its tables
// read back to choose from. Read by the names of their columns, and refused where one is not known,
// for it may tell rows apart that would be taken for one. Pure functions.
#pragma once

#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "accuracy/setting.h"
#include "glm/vec2.hpp"

namespace thunderhead::accuracy {

struct PricedSetting {
  Setting setting;
  double milliseconds = 0.0;   // a frame of a moved camera, at the table's size
  double relative_rmse = 0.0;  // of linear radiance, against the reference
};

struct PricedSettings {
  glm::ivec2 size_px{0};
  // All with one JPEG quality, the table's commonest: it changes bytes and not the radiance.
  std::vector<PricedSetting> rows;
};

// INVALID_ARGUMENT names what is missing, not known or not a number, and its line.
absl::StatusOr<PricedSettings> ReadPricedSettings(std::string_view text);

}  // namespace thunderhead::accuracy
