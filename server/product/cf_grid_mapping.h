// A map projection in the format of the Climate and Forecast conventions (CF-1.8, appendix F).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "product/map_place.h"

namespace thunderhead::product {

// The attributes of the grid mapping variable, which a data variable's attribute `grid_mapping`
// names.
struct CfGridMapping {
  // True for a grid in degrees of latitude and longitude whose cells are drawn as evenly spaced
  // metres. The conventions have no name for this projection, so its coordinates are written in
  // degrees.
  bool in_degrees = false;
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<double>> numbers;
};

// Returns the grid mapping of a projection. INVALID_ARGUMENT if storm files cannot have this
// projection.
absl::StatusOr<CfGridMapping> GridMappingOf(const MapProjection& projection);

}  // namespace thunderhead::product
