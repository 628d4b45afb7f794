#include "storm_files/cf_writer.h"

#include <array>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "netcdf/netcdf_writer.h"

namespace thunderhead::storm_files {
namespace {

// The variables of an axis.
struct AxisVariables {
  int centres = 0;
  int bounds = 0;
};

// Defines an axis with bounds, because a single cell has no size without them. `two` is the
// dimension of the two bounds of a cell.
AxisVariables Axis(netcdf::NetcdfWriter& file, const char* name, int dimension, int two,
                   const char* direction, const char* standard_name) {
  const std::string bounds = absl::StrCat(name, "_bounds");
  const AxisVariables axis{file.Variable(name, NC_DOUBLE, {dimension}),
                           file.Variable(bounds.c_str(), NC_DOUBLE, {dimension, two})};
  file.Text(axis.centres, "axis", direction);
  file.Text(axis.centres, "standard_name", standard_name);
  file.Text(axis.centres, "units", "m");
  file.Text(axis.centres, "bounds", bounds);
  if (direction[0] == 'Z') file.Text(axis.centres, "positive", "up");
  return axis;
}

void WriteAxis(netcdf::NetcdfWriter& file, const AxisVariables& axis, double low_m,
               double spacing_m, int cells) {
  std::vector<double> centres_m;
  std::vector<double> bounds_m;
  for (int i = 0; i < cells; ++i) {
    centres_m.push_back(low_m + (i + 0.5) * spacing_m);
    bounds_m.push_back(low_m + i * spacing_m);
    bounds_m.push_back(low_m + (i + 1) * spacing_m);
  }
  file.Values(axis.centres, centres_m);
  file.Values(axis.bounds, bounds_m);
}

// Returns the bytes of the file.
absl::StatusOr<std::string> Encoded(const CfCloud& cloud, const std::string& path) {
  const volume::RegularGrid& grid = cloud.grid;
  netcdf::NetcdfWriter file(path);
  file.Text(NC_GLOBAL, "Conventions", "CF-1.8");
  file.Text(NC_GLOBAL, "title", cloud.title);
  file.Text(NC_GLOBAL, "source", cloud.source);
  file.Text(NC_GLOBAL, "comment", cloud.comment);
  const auto dimension = [&](const char* name, int length) {
    return file.Dimension(name, static_cast<std::size_t>(length));
  };
  const int x = dimension("x", grid.cells.x);
  const int y = dimension("y", grid.cells.y);
  const int z = dimension("z", grid.cells.z);
  const int two = dimension("bounds", 2);
  const std::array axes = {Axis(file, "x", x, two, "X", "projection_x_coordinate"),
                           Axis(file, "y", y, two, "Y", "projection_y_coordinate"),
                           Axis(file, "z", z, two, "Z", "altitude")};
  const bool extinction = cloud.quantity == volume::Quantity::kExtinction;
  const int field = file.Variable(extinction ? "extinction" : "lwc", NC_FLOAT, {z, y, x});
  if (!extinction) {
    file.Text(field, "standard_name", "mass_concentration_of_cloud_liquid_water_in_air");
  }
  file.Text(field, "long_name", extinction ? "extinction" : "liquid water content");
  file.Text(field, "units", std::string(volume::UnitOf(cloud.quantity)));
  file.EndDefinitions();
  for (int axis = 0; axis < 3; ++axis) {
    WriteAxis(file, axes[static_cast<std::size_t>(axis)], grid.low_corner_m[axis],
              grid.spacing_m[axis], grid.cells[axis]);
  }
  file.Values(field, cloud.values);
  std::string bytes = file.Take();
  if (file.Good()) return bytes;
  return absl::UnavailableError(absl::StrCat(path, " cannot be encoded by netCDF-C (",
                                             nc_strerror(file.Code()),
                                             "); check that the machine has free memory"));
}

}  // namespace

absl::Status WriteCfCloud(const CfCloud& cloud, const std::string& path) {
  THUNDERHEAD_CHECK(cloud.quantity != volume::Quantity::kMixingRatio, path);
  THUNDERHEAD_CHECK(cloud.values.size() == cloud.grid.CellCount(), path);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string bytes, Encoded(cloud, path));
  return base::WriteWholeFile(path, bytes);
}

}  // namespace thunderhead::storm_files
