#include "storm_files/cf_format.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "base/status.h"
#include "netcdf/netcdf_file.h"
#include "storm_files/cf_metadata.h"
#include "storm_files/cf_parts.h"
#include "storm_files/cf_reader.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

// Returns StormFile::run: a text that describes the layers, which is the same for all files of one
// run. Fields are not part of it, because some files of a run may lack one.
std::string RunOf(const CfMetadata& metadata) {
  const CfHeights& heights = metadata.heights;
  std::string run = absl::StrCat(heights.name, " ", metadata.order.cells[2]);
  if (!heights.faces_m.empty()) {
    const double depth_m = heights.faces_m.back() - heights.faces_m.front();
    absl::StrAppend(&run, " ", heights.faces_m.front(), " ",
                    depth_m / static_cast<double>(metadata.order.cells[2]));
  }
  // Two forecasts of one time are two storms, so the text includes the start of a forecast's run. A
  // series of analyses is one storm, although each analysis is a separate run that starts at its
  // own time.
  if (metadata.run_start.has_value() && std::ranges::any_of(metadata.times, [&](absl::Time time) {
        return time != *metadata.run_start;
      })) {
    absl::StrAppend(&run, " ", absl::FormatTime(*metadata.run_start, absl::UTCTimeZone()));
  }
  return run;
}

volume::EarthPlace MiddleOf(const EvenColumns& even) {
  // A longitude that rounding has made slightly negative would be shown as west of Greenwich.
  constexpr double kRounding_deg = 1e-9;
  volume::EarthPlace middle = even.middle;
  if (std::abs(middle.longitude_deg) < kRounding_deg) middle.longitude_deg = 0.0;
  return middle;
}

// Returns StormFile::grid. The files of a series whose domain follows a storm have equal steps
// between their coordinates, to the accuracy of single precision. Their true distances differ, so
// the text contains only the steps. It is empty if the columns have no coordinates.
std::string GridOf(const CfMetadata& metadata) {
  if (metadata.x.unit == CfAxisUnit::kNone) return "";
  return absl::StrFormat("%d x %d columns, %.3g x %.3g %s", metadata.x.cells, metadata.y.cells,
                         metadata.x.Spacing(), metadata.y.Spacing(),
                         metadata.x.unit == CfAxisUnit::kDegrees ? "degrees" : "m");
}

class CfFormat final : public StormFormat {
 public:
  std::string_view Name() const override { return "a CF file"; }
  std::string_view Example() const override { return "CF netCDF"; }
  std::string_view Requirement() const override {
    return "a CF file with a hydrometeor (by standard name, e.g. "
           "mass_concentration_of_cloud_liquid_water_in_air) or a variable extinction (m-1)";
  }

  bool MayBegin(std::string_view start) const override {
    return netcdf::NetcdfFile::BeginsLikeNetcdf(start);
  }

  absl::Status PrepareBeforeConfinement() const override { return LoadUnits(); }

  FormatFit Sniff(const UnknownFile& file) const override {
    const bool fits =
        file.Netcdf().ok() && (LooksLikeCf(*file.Netcdf()) || HasOnlyHeights(*file.Netcdf()));
    return fits ? FormatFit::kConvention : FormatFit::kNone;
  }

  absl::StatusOr<StormFile> Describe(const UnknownFile& unknown) const override {
    THUNDERHEAD_RETURN_IF_ERROR(unknown.Netcdf().status());
    absl::StatusOr<CfMetadata> metadata = ReadCfMetadata(*unknown.Netcdf());
    if (metadata.ok()) return MembersOf(*std::move(metadata));
    if (std::optional<StormFile> part = PartOfCf(*unknown.Netcdf())) return *std::move(part);
    return metadata.status();
  }

  // One file has the fields of a time. Another one may have the heights.
  absl::StatusOr<StormFile> DescribeTogether(const std::vector<UnknownFile>& files) const override {
    const netcdf::NetcdfFile* fields = nullptr;
    const netcdf::NetcdfFile* heights = nullptr;
    for (const UnknownFile& each : files) {
      THUNDERHEAD_RETURN_IF_ERROR(each.Netcdf().status());
      const netcdf::NetcdfFile& file = *each.Netcdf();
      const netcdf::NetcdfFile*& place = HasOnlyHeights(file) ? heights : fields;
      if (place != nullptr) {
        return absl::InvalidArgumentError(
            absl::StrCat(file.Path(), " and ", place->Path(), " both have the ",
                         place == heights ? "heights" : "fields",
                         " of one time; put each run into a separate folder"));
      }
      place = &file;
    }
    if (fields == nullptr) {
      return absl::InvalidArgumentError(
          absl::StrCat(files.front().Path(), ": has heights but no fields; give it with a time"));
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(CfMetadata metadata, ReadCfMetadata(*fields, heights));
    return MembersOf(std::move(metadata));
  }

 private:
  // Describes the file's storms, one for each member of an ensemble.
  static StormFile MembersOf(CfMetadata metadata) {
    if (metadata.members.empty()) return Described(std::move(metadata));
    std::vector<StormFile> storms;
    for (metadata.order.member = 0; metadata.order.member < metadata.members.size();
         ++metadata.order.member) {
      storms.push_back(Described(metadata));
      storms.back().member = metadata.members[metadata.order.member];
    }
    StormFile first = std::move(storms.front());
    first.others.assign(std::make_move_iterator(storms.begin() + 1),
                        std::make_move_iterator(storms.end()));
    return first;
  }

  static StormFile Described(CfMetadata metadata) {
    StormFile file;
    file.path = metadata.path;
    const CfPlaces& places = metadata.places;
    file.cells = {metadata.x.cells, metadata.y.cells, static_cast<int>(metadata.order.cells[2])};
    file.dx_m = places.dx_m;
    file.dy_m = places.dy_m;
    file.times = metadata.times;
    for (const CfField& field : metadata.fields) {
      file.fields.push_back(field.quantity.hydrometeor);
    }
    file.about = metadata.source;
    file.run = RunOf(metadata);
    file.run_start = metadata.run_start;
    file.calendar = metadata.calendar;
    file.assumptions = metadata.assumptions;
    if (places.even != nullptr) {
      const EvenColumns& even = *places.even;
      file.cells = {even.columns.x, even.columns.y, file.cells.z};
      if (even.Resampled()) {
        file.dx_m = even.dx_m;
        file.dy_m = even.dy_m;
      }
      if (!even.projection.empty()) {
        const volume::EarthPlace middle = MiddleOf(even);
        file.longitude_deg = middle.longitude_deg;
        file.latitude_deg = middle.latitude_deg;
        file.projection = even.projection;
        file.grid = GridOf(metadata);
        for (const std::shared_ptr<const CfPlaces>& moved : metadata.moved) {
          const EvenColumns& at_record = moved == nullptr ? even : *moved->even;
          file.middles.push_back(MiddleOf(at_record));
          file.projections.push_back(at_record.projection);
        }
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
