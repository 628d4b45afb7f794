#include "storm_files/cf_format.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "storm_files/cf_metadata.h"
#include "storm_files/cf_reader.h"

namespace thunderhead::storm_files {
namespace {

class CfRecordReader final : public RecordReader {
 public:
  explicit CfRecordReader(CfMetadata metadata) : metadata_(std::move(metadata)) {}

  absl::StatusOr<volume::HydrometeorFields> Read(std::size_t record,
                                                 const std::optional<VerticalGrid>&,
                                                 const ReadCheckpoint& checkpoint) const override {
    return ReadCfTime(metadata_, record, checkpoint);
  }

  absl::StatusOr<VerticalGrid> ReadVerticalGrid(std::size_t) const override {
    const CfAxis& z = metadata_.axes[2];
    return VerticalGrid{z.low_m, z.spacing_m, z.cells};
  }

 private:
  const CfMetadata metadata_;
};

// Returns StormFile::run: a text with the names of the variables and their layers, which is the
// same for all files of one run.
std::string RunOf(const CfMetadata& metadata) {
  std::string run;
  for (const CfField& field : metadata.fields) absl::StrAppend(&run, field.variable.name, " ");
  const CfAxis& z = metadata.axes[2];
  absl::StrAppend(&run, z.low_m, " ", z.spacing_m, " ", z.cells);
  return run;
}

class CfFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "a CF file"; }
  std::string_view Example() const override { return "CF netCDF"; }
  std::string_view Requirement() const override {
    return "a CF file with a hydrometeor (by standard name, e.g. "
           "mass_concentration_of_cloud_liquid_water_in_air) or a variable extinction (m-1)";
  }

  FormatFit Sniff(const UnknownFile& file) const override {
    const bool fits = file.netcdf.ok() && LooksLikeCf(*file.netcdf);
    return fits ? FormatFit::kConvention : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& unknown) const override {
    THUNDERHEAD_RETURN_IF_ERROR(unknown.netcdf.status());
    THUNDERHEAD_ASSIGN_OR_RETURN(CfMetadata metadata, ReadCfMetadata(*unknown.netcdf));
    StormFile file;
    file.path = metadata.path;
    const auto& [x, y, z] = metadata.axes;
    file.cells = {x.file_cells, y.file_cells, z.file_cells};
    file.dx_m = x.spacing_m;
    file.dy_m = y.spacing_m;
    file.times = metadata.times;
    for (const CfField& field : metadata.fields) {
      file.fields.push_back(field.quantity.hydrometeor);
    }
    file.about = metadata.source;
    file.run = RunOf(metadata);
    if (x.middle_deg.has_value() && y.middle_deg.has_value()) {
      file.longitude_deg = x.middle_deg;
      file.latitude_deg = y.middle_deg;
      // A projection exists only for degrees of longitude and latitude. The reader converts degrees
      // to metres with one scale, that at the middle of the domain. Degrees of a rotated grid are
      // not places on Earth.
      const CfDescription described = DescribeCf(*unknown.netcdf, x.dimension);
      if (!absl::StartsWith(described.standard_name, "grid_")) {
        file.projection = absl::StrFormat(
            "+proj=eqc +lat_ts=%.10g +lat_0=%.10g +lon_0=%.10g +x_0=0 +y_0=0 +R=%.10g +units=m "
            "+no_defs",
            *y.middle_deg, *y.middle_deg, *x.middle_deg, kCfEarthRadius_m);
      }
    }
    file.reader = std::make_shared<CfRecordReader>(std::move(metadata));
    return file;
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeCfFormat() { return std::make_shared<CfFormat>(); }

}  // namespace thunderhead::storm_files
