// Finds the axes of a CF variable, and reads variables with any order and direction of dimensions.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_names.h"

namespace thunderhead::storm_files {

// A variable on some of the axes x, y, z and time, in any order.
struct CfVariable {
  std::string name;
  // The index of each axis among the variable's dimensions, or -1 if the variable does not have it.
  // Its values are then the same all along that axis.
  std::array<int, 3> places = {-1, -1, -1};  // x, y, z
  int time = -1;
  int member = -1;  // the same for the members of an ensemble
  int dimensions = 0;
  // 1 along an axis on which the variable has a value for each face between cells instead of each
  // cell.
  std::array<int, 3> more = {0, 0, 0};
  // The index along z of the first value that is read.
  std::size_t first_level = 0;
  // True if the variable is in the run's file of heights, which is not the file of the fields.
  bool of_heights_file = false;
};

// A dimension of a field, and the variable with its coordinate.
struct CfDimension {
  std::string name;
  std::string coordinate;  // empty if it has none
  std::size_t length = 1;
};

// The dimensions of the fields of a file.
struct CfDimensions {
  std::array<CfDimension, 3> axes;  // x, y, z
  std::string time;                 // empty if the fields have no time
  std::string member;               // of an ensemble's members; empty if there are none
  std::size_t members = 1;          // the length of that dimension
  // True if the columns are the cells of an unstructured grid, along one dimension. That dimension
  // is then both x and y, and y has the length 1.
  bool unstructured = false;
};

// Finds the axes of a field. Errors name the file, the variable and what is missing.
absl::StatusOr<CfDimensions> FindDimensions(const netcdf::NetcdfFile& file,
                                            const std::string& field);

// Returns how a variable lies on these dimensions. It may lack some of them, and it may lie on the
// faces between cells. Dimensions of length 1 are left out. An error names what does not fit.
absl::StatusOr<CfVariable> Arrange(const netcdf::NetcdfFile& file, const std::string& variable,
                                   const CfDimensions& on);

// The number of cells and the direction of the fields' axes, and the member that is read.
struct CfOrder {
  std::array<std::size_t, 3> cells = {1, 1, 1};
  std::array<bool, 3> reversed = {false, false, false};  // the axis runs west, south or down
  std::size_t member = 0;                                // the index along CfDimensions::member
};

// Reads one record of a variable, of one member. In the result x runs fastest (eastwards), then y
// (northwards), then z (upwards). Axes on which the variable has values on faces are longer by 1.
absl::StatusOr<std::vector<float>> ReadOnAxes(const netcdf::NetcdfFile& file,
                                              const CfVariable& variable, const CfOrder& order,
                                              std::size_t record);

// Returns the attributes of a variable, or of a dimension without a coordinate variable.
CfDescription DescribeCf(const netcdf::NetcdfFile& file, const std::string& variable);

// Returns the words of an attribute that lists names, such as `coordinates`.
std::vector<std::string> NamesIn(const std::string& attribute);

}  // namespace thunderhead::storm_files
