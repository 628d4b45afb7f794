#include "storm_files/wrf_format.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/date_time.h"
#include "storm_files/even_columns.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/units.h"
#include "storm_files/wrf_metadata.h"
#include "storm_files/wrf_reader.h"
#include "storm_files/wrf_relatives.h"

namespace thunderhead::storm_files {
namespace {

// Describes the columns that ReadOnHeights gives the storm.
void DescribeColumns(const WrfMetadata& metadata, StormFile& file) {
  file.cells = metadata.cells;
  file.dx_m = metadata.dx_m;
  file.dy_m = metadata.dy_m;
  // True distances change as a nest moves. Those on its map stay, so they identify the grid.
  if (metadata.nominal_m != metadata.on_map_m || metadata.even != nullptr) {
    file.grid = absl::StrCat(metadata.cells.x, " x ", metadata.cells.y, " columns, DX ",
                             metadata.on_map_m.x, ", DY ", metadata.on_map_m.y);
  }
  if (metadata.even == nullptr) return;
  const EvenColumns& even = *metadata.even;
  const glm::dvec2& nominal_m = metadata.nominal_m;
  if (even.Resampled()) {
    file.cells = {even.columns.x, even.columns.y, metadata.cells.z};
    file.dx_m = even.dx_m;
    file.dy_m = even.dy_m;
  } else if (std::min(nominal_m.x, nominal_m.y) == 0.0) {
    file.assumptions.push_back(absl::StrFormat(
        "The columns are %.0f m by %.0f m apart, as their latitudes and longitudes say, because "
        "the file has no attributes DX and DY.",
        file.dx_m, file.dy_m));
  } else if (glm::dvec2(file.dx_m, file.dy_m) != nominal_m) {
    file.assumptions.push_back(absl::StrFormat(
        "The columns are %.0f m by %.0f m apart, as their latitudes and longitudes say; DX and DY, "
        "which are lengths on the model's map, are %.0f m and %.0f m.",
        file.dx_m, file.dy_m, nominal_m.x, nominal_m.y));
  }
  std::ranges::copy(AssumptionsOf(even), std::back_inserter(file.assumptions));
}

class WrfFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "WRF output"; }
  std::string_view Example() const override { return "wrfout_..."; }
  std::string_view Requirement() const override {
    return "WRF output (it has no dimensions west_east, south_north, bottom_top)";
  }

  bool MayBegin(std::string_view start) const override {
    return netcdf::NetcdfFile::BeginsLikeNetcdf(start);
  }

  absl::Status PrepareBeforeConfinement() const override { return LoadUnits(); }

  FormatFit Sniff(const UnknownFile& file) const override {
    if (!file.Netcdf().ok()) return FormatFit::kNone;
    const auto has = [&file](const char* name) {
      return file.Netcdf()->DimensionLength(name).has_value();
    };
    const bool dimensions =
        has("bottom_top") || has("bottom_top_stag") || (has("west_east") && has("south_north"));
    // Programs such as CDO rename the dimensions and keep the variables.
    const bool variables = file.Netcdf()->HasVariable("PHB") && file.Netcdf()->HasVariable("PB");
    if (dimensions || variables || IsOnEta(*file.Netcdf())) return FormatFit::kModelLayout;
    return HasWrfTitle(*file.Netcdf()) ? FormatFit::kRelated : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& unknown) const override {
    THUNDERHEAD_RETURN_IF_ERROR(unknown.Netcdf().status());
    THUNDERHEAD_ASSIGN_OR_RETURN(WrfMetadata metadata, ReadWrfMetadata(*unknown.Netcdf()));
    StormFile file;
    file.path = metadata.path;
    DescribeColumns(metadata, file);
    file.times = metadata.times;
    file.fields = metadata.fields;
    file.about = metadata.model;
    if (metadata.place.idealised) {
      absl::StrAppend(&file.about, file.about.empty() ? "" : ", ", "idealised");
    }
    file.domain = metadata.domain;
    file.run = metadata.simulation_start;
    file.run_start = ParseDateTime(metadata.simulation_start);
    if (metadata.place.middle.has_value()) {
      file.latitude_deg = metadata.place.middle->latitude_deg;
      file.longitude_deg = metadata.place.middle->longitude_deg;
    }
    file.middles = metadata.place.middles;
    file.projection = metadata.place.projection;
    file.projections = metadata.place.projections;
    std::ranges::copy(metadata.assumptions, std::back_inserter(file.assumptions));
    file.reader =
        MakeRecordReader([metadata = std::make_shared<const WrfMetadata>(std::move(metadata))](
                             std::size_t record) { return OpenWrfTime(metadata, record); });
    return file;
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeWrfFormat() { return std::make_shared<WrfFormat>(); }

}  // namespace thunderhead::storm_files
