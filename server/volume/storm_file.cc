#include "volume/storm_file.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "volume/cf_reader.h"
#include "volume/wrf_reader.h"

namespace thunderhead::volume {
namespace {

bool LooksLikeWrf(const NetcdfFile& file) {
  const auto has = [&file](const char* name) { return file.DimensionLength(name).has_value(); };
  return has("bottom_top") || has("bottom_top_stag") || (has("west_east") && has("south_north"));
}

StormFile FromWrf(WrfMetadata metadata) {
  StormFile file;
  file.path = metadata.path;
  file.cells = metadata.cells;
  file.dx_m = metadata.dx_m;
  file.dy_m = metadata.dy_m;
  file.times = metadata.times;
  file.fields = metadata.fields;
  file.about = metadata.model;
  if (metadata.idealised) absl::StrAppend(&file.about, file.about.empty() ? "" : ", ", "idealised");
  file.domain = metadata.domain;
  file.run = metadata.simulation_start;
  file.latitude_deg = metadata.latitude_deg;
  file.longitude_deg = metadata.longitude_deg;
  file.metadata = std::move(metadata);
  return file;
}

StormFile FromCf(CfMetadata metadata) {
  StormFile file;
  file.path = metadata.path;
  const auto& [x, y, z] = metadata.axes;
  file.cells = {x.file_cells, y.file_cells, z.file_cells};
  file.dx_m = x.spacing_m;
  file.dy_m = y.spacing_m;
  file.times = metadata.times;
  for (const CfField& field : metadata.fields) {
    file.fields.push_back(field.quantity.hydrometeor);
    absl::StrAppend(&file.run, field.variable.name, " ");
  }
  absl::StrAppend(&file.run, z.low_m, " ", z.spacing_m, " ", z.cells);
  file.about = metadata.source;
  if (x.middle_deg.has_value() && y.middle_deg.has_value()) {
    file.longitude_deg = x.middle_deg;
    file.latitude_deg = y.middle_deg;
  }
  file.metadata = std::move(metadata);
  return file;
}

}  // namespace

absl::StatusOr<StormFile> ReadStormFile(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const NetcdfFile file, NetcdfFile::Open(path));
  if (LooksLikeWrf(file)) {
    THUNDERHEAD_ASSIGN_OR_RETURN(WrfMetadata metadata, ReadWrfMetadata(file));
    return FromWrf(std::move(metadata));
  }
  if (LooksLikeCf(file)) {
    THUNDERHEAD_ASSIGN_OR_RETURN(CfMetadata metadata, ReadCfMetadata(file));
    return FromCf(std::move(metadata));
  }
  return absl::InvalidArgumentError(absl::StrCat(
      path,
      ": is neither WRF output (it has no dimensions west_east, south_north, bottom_top) nor "
      "a CF file with a hydrometeor (by standard name, e.g. "
      "mass_concentration_of_cloud_liquid_water_in_air) or a variable extinction (m-1); give "
      "a file that is"));
}

absl::StatusOr<HydrometeorFields> ReadTime(
    const StormFile& file, std::size_t record, const std::optional<VerticalGrid>& grid,
    const std::function<absl::Status(double share)>& checkpoint) {
  if (const auto* cf = std::get_if<CfMetadata>(&file.metadata); cf != nullptr) {
    return ReadCfTime(*cf, record, checkpoint);
  }
  return ReadWrfTime(std::get<WrfMetadata>(file.metadata), record, grid, checkpoint);
}

absl::StatusOr<VerticalGrid> ReadVerticalGrid(const StormFile& file, std::size_t record) {
  if (const auto* cf = std::get_if<CfMetadata>(&file.metadata); cf != nullptr) {
    const CfAxis& z = cf->axes[2];
    return VerticalGrid{z.low_m, z.spacing_m, z.cells};
  }
  return ReadWrfVerticalGrid(std::get<WrfMetadata>(file.metadata), record);
}

}  // namespace thunderhead::volume
