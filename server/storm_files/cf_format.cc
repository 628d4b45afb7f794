#include "storm_files/cf_format.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "storm_files/cf_metadata.h"
#include "storm_files/cf_reader.h"
#include "storm_files/fields_on_heights.h"

namespace thunderhead::storm_files {
namespace {

// Returns StormFile::run: a text with the names of the variables and their layers, which is the
// same for all files of one run.
std::string RunOf(const CfMetadata& metadata) {
  std::string run;
  for (const CfField& field : metadata.fields) absl::StrAppend(&run, field.variable.name, " ");
  const CfAxis& z = metadata.axes[2];
  absl::StrAppend(&run, z.faces_m.front(), " ", z.spacing_m, " ", z.cells);
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
    const bool fits = file.Netcdf().ok() && LooksLikeCf(*file.Netcdf());
    return fits ? FormatFit::kConvention : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& unknown) const override {
    THUNDERHEAD_RETURN_IF_ERROR(unknown.Netcdf().status());
    THUNDERHEAD_ASSIGN_OR_RETURN(CfMetadata metadata, ReadCfMetadata(*unknown.Netcdf()));
    StormFile file;
    file.path = metadata.path;
    const auto& [x, y, z] = metadata.axes;
    file.cells = {x.cells, y.cells, z.cells};
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
      const CfDescription described = DescribeCf(*unknown.Netcdf(), x.dimension);
      if (!absl::StartsWith(described.standard_name, "grid_")) {
        file.projection = absl::StrFormat(
            "+proj=eqc +lat_ts=%.10g +lat_0=%.10g +lon_0=%.10g +x_0=0 +y_0=0 +R=%.10g +units=m "
            "+no_defs",
            *y.middle_deg, *y.middle_deg, *x.middle_deg, kCfEarthRadius_m);
      }
    }
    file.reader =
        MakeRecordReader([metadata = std::make_shared<const CfMetadata>(std::move(metadata))](
                             std::size_t record) { return OpenCfTime(metadata, record); });
    return file;
  }
};

}  // namespace

std::shared_ptr<const StormFormat> MakeCfFormat() { return std::make_shared<CfFormat>(); }

}  // namespace thunderhead::storm_files
