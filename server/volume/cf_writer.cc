#include "volume/cf_writer.h"

#include <netcdf.h>

#include <array>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "volume/netcdf_lock.h"

namespace thunderhead::volume {
namespace {

// A file being written; keeps the first error of netCDF-C, after which calls do nothing.
class Writer {
 public:
  explicit Writer(const std::string& path) {
    Keep(nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &file_));
    open_ = code_ == NC_NOERR;
  }
  ~Writer() { Close(); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  int Axis(const char* name, int cells, const char* direction, const char* standard_name) {
    int dimension = 0;
    int variable = 0;
    if (Good()) Keep(nc_def_dim(file_, name, static_cast<std::size_t>(cells), &dimension));
    if (Good()) Keep(nc_def_var(file_, name, NC_DOUBLE, 1, &dimension, &variable));
    Text(variable, "axis", direction);
    Text(variable, "standard_name", standard_name);
    Text(variable, "units", "m");
    if (direction[0] == 'Z') Text(variable, "positive", "up");
    return variable;
  }

  void Text(int variable, const char* name, const std::string& text) {
    if (Good()) Keep(nc_put_att_text(file_, variable, name, text.size(), text.c_str()));
  }

  int Field(const char* name) {
    // Dimensions are numbered in the order of their definition: x, y, z.
    constexpr std::array<int, 3> kDimensions = {2, 1, 0};
    int variable = 0;
    if (Good()) Keep(nc_def_var(file_, name, NC_FLOAT, 3, kDimensions.data(), &variable));
    if (Good()) Keep(nc_def_var_deflate(file_, variable, 1, 1, 4));
    return variable;
  }

  void EndDefinitions() {
    if (Good()) Keep(nc_enddef(file_));
  }

  void Middles(int variable, double low_m, double spacing_m, int cells) {
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(cells));
    for (int i = 0; i < cells; ++i) values.push_back(low_m + (i + 0.5) * spacing_m);
    if (Good()) Keep(nc_put_var_double(file_, variable, values.data()));
  }

  void Values(int variable, const std::vector<float>& values) {
    if (Good()) Keep(nc_put_var_float(file_, variable, values.data()));
  }

  void Close() {
    if (!open_) return;
    open_ = false;
    Keep(nc_close(file_));
  }

  bool Good() const { return code_ == NC_NOERR; }
  int Code() const { return code_; }

 private:
  void Keep(int code) {
    if (code_ == NC_NOERR) code_ = code;
  }

  int file_ = 0;
  int code_ = NC_NOERR;
  bool open_ = false;
};

int Write(const CfCloud& cloud, const std::string& path) {
  const RegularGrid& grid = cloud.grid;
  const NetcdfLock lock(path);
  Writer file(path);
  file.Text(NC_GLOBAL, "Conventions", "CF-1.8");
  file.Text(NC_GLOBAL, "title", cloud.title);
  file.Text(NC_GLOBAL, "source", cloud.source);
  file.Text(NC_GLOBAL, "comment", cloud.comment);
  const std::array axes = {file.Axis("x", grid.cells.x, "X", "projection_x_coordinate"),
                           file.Axis("y", grid.cells.y, "Y", "projection_y_coordinate"),
                           file.Axis("z", grid.cells.z, "Z", "altitude")};
  const bool extinction = cloud.quantity == Quantity::kExtinction;
  const int field = file.Field(extinction ? "extinction" : "lwc");
  if (!extinction) {
    file.Text(field, "standard_name", "mass_concentration_of_cloud_liquid_water_in_air");
  }
  file.Text(field, "long_name", extinction ? "extinction" : "liquid water content");
  file.Text(field, "units", std::string(UnitOf(cloud.quantity)));
  file.EndDefinitions();
  for (int axis = 0; axis < 3; ++axis) {
    file.Middles(axes[static_cast<std::size_t>(axis)], grid.low_corner_m[axis],
                 grid.spacing_m[axis], grid.cells[axis]);
  }
  file.Values(field, cloud.values);
  file.Close();
  return file.Code();
}

}  // namespace

absl::Status WriteCfCloud(const CfCloud& cloud, const std::string& path) {
  THUNDERHEAD_CHECK(cloud.quantity != Quantity::kMixingRatio, path);
  THUNDERHEAD_CHECK(cloud.values.size() == cloud.grid.CellCount(), path);
  const std::string partial = base::PartialPath(path);
  const int code = Write(cloud, partial);
  if (code == NC_NOERR) return base::PublishFile(path);
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
  return absl::UnavailableError(absl::StrCat(path, " cannot be written (", nc_strerror(code),
                                             "); check that its folder exists and has room"));
}

}  // namespace thunderhead::volume
