// Writes small CF files with any axes and variables. It calls netCDF-C without a lock, so tests
// must write their files before anything reads.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace thunderhead::testing {

struct CfCoordinate {
  std::string name;
  std::vector<double> values;  // their number is the length of the dimension
  std::map<std::string, std::string> attributes;
  std::vector<double> faces;  // one more than values; written as bounds
  bool written = true;        // false: a dimension without a coordinate variable
};

struct CfContent {
  std::string name;
  std::vector<std::string> dimensions;  // slowest-varying first
  std::map<std::string, std::string> attributes;
  // Returns the value at indices along x, y, z and time, by the coordinates' names. The value is 0
  // for other coordinates.
  std::function<double(const std::map<std::string, std::size_t>&)> value;
};

struct SyntheticCf {
  std::vector<CfCoordinate> coordinates;
  std::vector<CfContent> variables;
  std::map<std::string, std::string> attributes;
  std::map<std::string, std::string>
      bounds_attributes;  // attributes of the bounds of every coordinate
  // Numeric attributes, by variable and name.
  std::map<std::string, std::map<std::string, double>> number_attributes;
};

void WriteCf(const SyntheticCf& file, const std::string& path);

// Returns the centres of `count` equal cells that begin at `low`.
std::vector<double> Middles(std::size_t count, double low, double spacing);

// Returns a file with the variable `extinction` (1/m) on z, y, x in metres.
SyntheticCf ExtinctionFile(std::size_t nx, std::size_t ny, std::size_t nz, double dx_m, double dy_m,
                           double dz_m,
                           std::function<double(std::size_t, std::size_t, std::size_t)> value);

}  // namespace thunderhead::testing
