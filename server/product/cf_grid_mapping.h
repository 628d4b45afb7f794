// A map projection in the format of the Climate and Forecast conventions (CF-1.8, appendix F).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "volume/map_projection.h"

namespace thunderhead::product {

// A coordinate axis of a map in this mapping. A value on it is `origin` + `per_metre` times the
// projection's own coordinate.
struct CfMapAxis {
  std::string name;  // name of the dimension and of its variable
  std::string units;
  std::string standard_name;
  double origin = 0.0;
  double per_metre = 1.0;
};

// The attributes of the grid mapping variable, which a data variable's attribute `grid_mapping`
// names, and the axes of a map.
struct CfGridMapping {
  CfMapAxis x;
  CfMapAxis y;
  // True if the axes are longitude and latitude. The conventions have no name for the projection of
  // a grid in degrees that is drawn as evenly spaced metres, so its coordinates are in degrees.
  bool in_degrees = false;
  std::map<std::string, std::string> texts;
  std::map<std::string, std::vector<double>> numbers;
};

// Returns the grid mapping of a projection, or INVALID_ARGUMENT if the conventions have no name for
// the projection.
absl::StatusOr<CfGridMapping> GridMappingOf(const volume::MapProjection& projection);

}  // namespace thunderhead::product
