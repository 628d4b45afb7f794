// A map projection as the Climate and Forecast conventions write it (CF-1.8, appendix F).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "product/map_place.h"

namespace thunderhead::product {

// Attributes of the variable that `grid_mapping` names.
struct CfGridMapping {
  // The conventions have no name for degrees that are drawn as evenly spaced metres: such a grid
  // is written in the degrees.
  bool in_degrees = false;
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<double>> numbers;
};

// The grid mapping of projections that storm files have. INVALID_ARGUMENT for others.
absl::StatusOr<CfGridMapping> GridMappingOf(const MapProjection& projection);

}  // namespace thunderhead::product
