// A map projection in the format of the Climate and Forecast conventions (CF-1.8, appendix F).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "product/map_place.h"

namespace thunderhead::product {

// The attributes of the variable that `grid_mapping` names.
struct CfGridMapping {
  // The conventions have no name for a grid in degrees whose cells are drawn as evenly spaced
  // metres. Coordinates of such a grid are written in degrees.
  bool in_degrees = false;
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<double>> numbers;
};

// Returns the grid mapping of a projection that storm files use. INVALID_ARGUMENT for others.
absl::StatusOr<CfGridMapping> GridMappingOf(const MapProjection& projection);

}  // namespace thunderhead::product
