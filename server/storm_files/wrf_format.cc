#include "storm_files/wrf_format.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "storm_files/wrf_metadata.h"
#include "storm_files/wrf_reader.h"

namespace thunderhead::storm_files {
namespace {

class WrfRecordReader final : public RecordReader {
 public:
  explicit WrfRecordReader(WrfMetadata metadata) : metadata_(std::move(metadata)) {}

  absl::StatusOr<volume::HydrometeorFields> Read(std::size_t record,
                                                 const std::optional<VerticalGrid>& grid,
                                                 const ReadCheckpoint& checkpoint) const override {
    return ReadWrfTime(metadata_, record, grid, checkpoint);
  }

  absl::StatusOr<VerticalGrid> ReadVerticalGrid(std::size_t record) const override {
    return ReadWrfVerticalGrid(metadata_, record);
  }

 private:
  const WrfMetadata metadata_;
};

class WrfFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "WRF output"; }
  std::string_view Example() const override { return "wrfout_..."; }
  std::string_view Requirement() const override {
    return "WRF output (it has no dimensions west_east, south_north, bottom_top)";
  }

  FormatFit Sniff(const UnknownFile& file) const override {
    if (!file.netcdf.ok()) return FormatFit::kNone;
    const auto has = [&file](const char* name) {
      return file.netcdf->DimensionLength(name).has_value();
    };
    const bool fits =
        has("bottom_top") || has("bottom_top_stag") || (has("west_east") && has("south_north"));
    return fits ? FormatFit::kModelLayout : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& unknown) const override {
    THUNDERHEAD_RETURN_IF_ERROR(unknown.netcdf.status());
    THUNDERHEAD_ASSIGN_OR_RETURN(WrfMetadata metadata, ReadWrfMetadata(*unknown.netcdf));
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
    file.reader = std::make_shared<WrfRecordReader>(std::move(metadata));
    return file;
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeWrfFormat() { return std::make_shared<WrfFormat>(); }

}  // namespace thunderhead::storm_files
