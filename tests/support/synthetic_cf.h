// Writes small netCDF files by the CF conventions, with any axes and variables. This code calls
// netCDF-C without a lock, so a test must write its files before another thread reads.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace thunderhead::testing {

struct CfCoordinate {
  std::string name;
  std::vector<double> values;  // coordinates; their number is the length of the dimension
  std::map<std::string, std::string> attributes;
  // Cell faces, one more than there are values; written as the coordinate's bounds.
  std::vector<double> faces;
  bool written = true;  // if false, the dimension has no coordinate variable
};

struct CfContent {
  std::string name;
  // Names of the variable's dimensions, the slowest-varying first.
  std::vector<std::string> dimensions;
  std::map<std::string, std::string> attributes;
  // Returns the variable's value. The argument maps the name of each of the variable's dimensions
  // to an index along it.
  std::function<double(const std::map<std::string, std::size_t>&)> value;
};

struct SyntheticCf {
  std::vector<CfCoordinate> coordinates;
  std::vector<CfContent> variables;
  std::map<std::string, std::string> attributes;
  // Attributes of the bounds variables of all coordinates.
  std::map<std::string, std::string> bounds_attributes;
  // Numeric attributes, by the variable's name and then by the attribute's name. Global attributes
  // have an empty variable name.
  std::map<std::string, std::map<std::string, double>> number_attributes;
};

void WriteCf(const SyntheticCf& file, const std::string& path);

// Returns the centres of `count` cells of size `spacing`, of which the first begins at `low`.
std::vector<double> Middles(std::size_t count, double low, double spacing);

// Returns a file with the variable `extinction` (1/m), whose dimensions are z, y, x in metres.
// `value` returns the extinction of a cell.
SyntheticCf ExtinctionFile(std::size_t nx, std::size_t ny, std::size_t nz, double dx_m, double dy_m,
                           double dz_m,
                           std::function<double(std::size_t, std::size_t, std::size_t)> value);

}  // namespace thunderhead::testing
