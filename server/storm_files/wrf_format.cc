#include "storm_files/wrf_format.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/wrf_metadata.h"
#include "storm_files/wrf_reader.h"

namespace thunderhead::storm_files {
namespace {

class WrfFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "WRF output"; }
  std::string_view Example() const override { return "wrfout_..."; }
  std::string_view Requirement() const override {
    return "WRF output (it has no dimensions west_east, south_north, bottom_top)";
  }

  FormatFit Sniff(const UnknownFile& file) const override {
    if (!file.Netcdf().ok()) return FormatFit::kNone;
    const auto has = [&file](const char* name) {
      return file.Netcdf()->DimensionLength(name).has_value();
    };
    const bool fits =
        has("bottom_top") || has("bottom_top_stag") || (has("west_east") && has("south_north"));
    return fits ? FormatFit::kModelLayout : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& unknown) const override {
    THUNDERHEAD_RETURN_IF_ERROR(unknown.Netcdf().status());
    THUNDERHEAD_ASSIGN_OR_RETURN(WrfMetadata metadata, ReadWrfMetadata(*unknown.Netcdf()));
    StormFile file;
    file.path = metadata.path;
    file.cells = metadata.cells;
    file.dx_m = metadata.dx_m;
    file.dy_m = metadata.dy_m;
    file.times = metadata.times;
    file.fields = metadata.fields;
    file.about = metadata.model;
    if (metadata.idealised) {
      absl::StrAppend(&file.about, file.about.empty() ? "" : ", ", "idealised");
    }
    file.domain = metadata.domain;
    file.run = metadata.simulation_start;
    file.latitude_deg = metadata.latitude_deg;
    file.longitude_deg = metadata.longitude_deg;
    file.projection = metadata.projection;
    file.reader =
        MakeRecordReader([metadata = std::make_shared<const WrfMetadata>(std::move(metadata))](
                             std::size_t record) { return OpenWrfTime(metadata, record); });
    return file;
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeWrfFormat() { return std::make_shared<WrfFormat>(); }

}  // namespace thunderhead::storm_files
