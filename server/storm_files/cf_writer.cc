#include "storm_files/cf_writer.h"

#include <array>
#include <filesystem>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "netcdf/netcdf_writer.h"

namespace thunderhead::storm_files {
namespace {

int Axis(netcdf::NetcdfWriter& file, const char* name, int cells, const char* direction,
         const char* standard_name) {
  const int variable =
      file.Variable(name, NC_DOUBLE, {file.Dimension(name, static_cast<std::size_t>(cells))});
  file.Text(variable, "axis", direction);
  file.Text(variable, "standard_name", standard_name);
  file.Text(variable, "units", "m");
  if (direction[0] == 'Z') file.Text(variable, "positive", "up");
  return variable;
}

std::vector<double> Middles(double low_m, double spacing_m, int cells) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(cells));
  for (int i = 0; i < cells; ++i) values.push_back(low_m + (i + 0.5) * spacing_m);
  return values;
}

int Write(const CfCloud& cloud, const std::string& path) {
  const volume::RegularGrid& grid = cloud.grid;
  netcdf::NetcdfWriter file(path);
  file.Text(NC_GLOBAL, "Conventions", "CF-1.8");
  file.Text(NC_GLOBAL, "title", cloud.title);
  file.Text(NC_GLOBAL, "source", cloud.source);
  file.Text(NC_GLOBAL, "comment", cloud.comment);
  const std::array axes = {Axis(file, "x", grid.cells.x, "X", "projection_x_coordinate"),
                           Axis(file, "y", grid.cells.y, "Y", "projection_y_coordinate"),
                           Axis(file, "z", grid.cells.z, "Z", "altitude")};
  const bool extinction = cloud.quantity == volume::Quantity::kExtinction;
  // NetCDF numbers dimensions in the order of their definition: x, y, z.
  const int field = file.Variable(extinction ? "extinction" : "lwc", NC_FLOAT, {2, 1, 0});
  if (!extinction) {
    file.Text(field, "standard_name", "mass_concentration_of_cloud_liquid_water_in_air");
  }
  file.Text(field, "long_name", extinction ? "extinction" : "liquid water content");
  file.Text(field, "units", std::string(volume::UnitOf(cloud.quantity)));
  file.EndDefinitions();
  for (int axis = 0; axis < 3; ++axis) {
    file.Values(axes[static_cast<std::size_t>(axis)],
                Middles(grid.low_corner_m[axis], grid.spacing_m[axis], grid.cells[axis]));
  }
  file.Values(field, cloud.values);
  file.Close();
  return file.Code();
}

}  // namespace

absl::Status WriteCfCloud(const CfCloud& cloud, const std::string& path) {
  THUNDERHEAD_CHECK(cloud.quantity != volume::Quantity::kMixingRatio, path);
  THUNDERHEAD_CHECK(cloud.values.size() == cloud.grid.CellCount(), path);
  const std::string partial = base::PartialPath(path);
  const int code = Write(cloud, partial);
  if (code == NC_NOERR) return base::PublishFile(path);
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
  return absl::UnavailableError(absl::StrCat(path, " cannot be written (", nc_strerror(code),
                                             "); check that its folder exists and has room"));
}

}  // namespace thunderhead::storm_files
