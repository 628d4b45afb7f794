#include "storm_files/grib_storm.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "grib/decompressed.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/grib_parts.h"

namespace thunderhead::storm_files {
namespace {

// Returns "+1 h" or "+70 min".
std::string StepText(absl::Duration step) {
  const auto minutes = static_cast<int>(absl::ToInt64Minutes(step));
  if (minutes % 60 == 0) return absl::StrFormat("%+d h", minutes / 60);
  return absl::StrFormat("%+d min", minutes);
}

// Returns "NCEP HRRR, run 2024-05-20 21:00 UTC, +1 h, mem03".
std::string AboutText(const GribContents& contents) {
  std::string about = absl::StrCat(
      contents.model.name, ", run ",
      absl::FormatTime("%Y-%m-%d %H:%M UTC", contents.origin.reference, absl::UTCTimeZone()));
  const absl::Duration first = contents.times.front().time - contents.origin.reference;
  const absl::Duration last = contents.times.back().time - contents.origin.reference;
  absl::StrAppend(&about, ", ", StepText(first));
  if (last != first) absl::StrAppend(&about, " to ", StepText(last));
  if (!contents.member.empty()) absl::StrAppend(&about, ", ", contents.member);
  return about;
}

}  // namespace

GribInput GribFileAt(const std::string& path) {
  return {path, [path] { return base::OpenBytes(path); }};
}

absl::StatusOr<std::shared_ptr<const grib::Index>> IndexOfGrib(
    std::shared_ptr<const base::ByteSource> bytes) {
  THUNDERHEAD_ASSIGN_OR_RETURN(bytes, grib::Decompressed(std::move(bytes)));
  THUNDERHEAD_ASSIGN_OR_RETURN(grib::Index index, grib::ReadIndex(*bytes));
  return std::make_shared<const grib::Index>(std::move(index));
}

absl::StatusOr<std::vector<std::shared_ptr<const GribStorm>>> MakeGribStorms(
    const std::string& path, const std::vector<GribInput>& files, const GribIndexes& indexes) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<GribContents> found, FindGribStorms(path, indexes));
  std::vector<std::shared_ptr<const GribStorm>> storms;
  for (GribContents& contents : found) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckRecords(path, contents.times.size()));
    storms.push_back(
        std::make_shared<const GribStorm>(GribStorm{files, indexes, std::move(contents)}));
  }
  return storms;
}

StormFile DescribeGribStorm(std::shared_ptr<const GribStorm> storm) {
  const GribContents& contents = storm->contents;
  StormFile file;
  file.path = contents.path;
  file.cells = {contents.grid.columns, contents.grid.rows,
                static_cast<int>(contents.times.front().levels.size())};
  file.dx_m = contents.grid.dx_m;
  file.dy_m = contents.grid.dy_m;
  for (const GribLayers& layers : contents.times) file.times.push_back(layers.time);
  for (const GribHydrometeor& hydrometeor : contents.times.front().hydrometeors) {
    file.fields.push_back(hydrometeor.hydrometeor);
  }
  file.about = AboutText(contents);
  file.run = absl::StrCat(GribRunOf(contents.origin), ", process ", contents.process, ", ",
                          contents.level_kind);
  file.member = contents.member;
  file.latitude_deg = contents.grid.latitude_deg;
  file.longitude_deg = contents.grid.longitude_deg;
  file.projection = contents.grid.projection;
  file.assumptions = contents.assumptions;
  file.reader = MakeRecordReader(
      [storm = std::move(storm)](std::size_t record) { return OpenGribTime(storm, record); });
  return file;
}

}  // namespace thunderhead::storm_files
