#include "storm_files/grib_storm.h"

#include <algorithm>
#include <iterator>
#include <new>
#include <stdexcept>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/memory_fit.h"
#include "base/status.h"
#include "glm/vec2.hpp"
#include "grib/decompressed.h"
#include "storm_files/cell_columns.h"
#include "storm_files/even_columns.h"
#include "storm_files/fields_on_heights.h"
#include "storm_files/grib_columns.h"
#include "storm_files/grib_parts.h"

namespace thunderhead::storm_files {
namespace {

// Places the cells of an unstructured grid by their latitudes and longitudes, which are in the
// grid's rows or in separate fields.
absl::StatusOr<EvenColumns> PlaceGribCells(const GribStorm& storm) {
  const GribContents& contents = storm.contents;
  CellPlaces places;
  for (const grib::CellRow& row : contents.grid.cell_rows) {
    for (int i = 0; i < row.cells; ++i) {
      places.latitude_deg.push_back(row.latitude_deg);
      places.longitude_deg.push_back(row.first_longitude_deg + i * row.step_deg);
    }
  }
  if (!places.latitude_deg.empty()) return MakeEvenOfCells(places);
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> latitude_deg,
                               ReadGribField(storm, contents.cell_latitude));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> longitude_deg,
                               ReadGribField(storm, contents.cell_longitude));
  places.latitude_deg.assign(latitude_deg.begin(), latitude_deg.end());
  places.longitude_deg.assign(longitude_deg.begin(), longitude_deg.end());
  return MakeEvenOfCells(places);
}

// Places the columns of the storm's grid. Running out of memory counts as an error of the input,
// because a message of few bytes may have a huge grid.
absl::StatusOr<EvenColumns> PlaceGribColumns(const GribStorm& storm) {
  const grib::Grid& grid = storm.contents.grid;
  constexpr std::size_t kColumn_bytes = sizeof(FromColumn) + sizeof(glm::dvec2);
  THUNDERHEAD_RETURN_IF_ERROR(
      base::CountThatFits("the grid", {grid.Points()}, kColumn_bytes).status());
  try {
    return grid.IsUnstructured() ? PlaceGribCells(storm) : MakeEven(PlacesOf(grid));
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  return absl::ResourceExhaustedError(absl::StrCat(
      "the places of its ", grid.Points(), " columns do not fit in memory; cut a smaller domain"));
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
    auto storm = std::make_shared<GribStorm>();
    storm->files = files;
    storm->indexes = indexes;
    storm->contents = std::move(contents);
    // The members of an ensemble share a grid, whose columns are placed once.
    const auto same = std::ranges::find_if(
        storms, [&](const auto& other) { return other->contents.grid == storm->contents.grid; });
    if (same != storms.end()) {
      storm->even = (*same)->even;
    } else {
      absl::StatusOr<EvenColumns> even = PlaceGribColumns(*storm);
      if (!even.ok()) return base::Annotate(even.status(), path);
      storm->even = std::make_shared<const EvenColumns>(*std::move(even));
    }
    storms.push_back(std::move(storm));
  }
  return storms;
}

StormFile DescribeGribStorm(std::shared_ptr<const GribStorm> storm) {
  const GribContents& contents = storm->contents;
  StormFile file;
  file.path = contents.path;
  const EvenColumns& even = *storm->even;
  file.cells = {even.columns.x, even.columns.y,
                static_cast<int>(contents.times.front().levels.size())};
  file.dx_m = even.dx_m;
  file.dy_m = even.dy_m;
  // A grid that follows a storm has different true distances in each file, so the text has the
  // steps on the map instead.
  if (!contents.grid.IsUnstructured()) {
    file.grid = absl::StrFormat("%d x %d columns, %.6g x %.6g of its map", contents.grid.columns,
                                contents.grid.rows, contents.grid.step.x, contents.grid.step.y);
  }
  for (const GribLayers& layers : contents.times) file.times.push_back(layers.time);
  for (const GribHydrometeor& hydrometeor : contents.times.front().hydrometeors) {
    file.fields.push_back(hydrometeor.hydrometeor);
  }
  file.about = contents.model.name;
  file.run = absl::StrCat(GribRunOf(contents.origin), ", process ", contents.process, ", ",
                          contents.level_kind);
  file.run_start = contents.origin.reference;
  file.member = contents.member;
  file.latitude_deg = even.middle.latitude_deg;
  file.longitude_deg = even.middle.longitude_deg;
  file.projection = even.projection;
  file.assumptions = contents.assumptions;
  std::ranges::copy(AssumptionsOf(even), std::back_inserter(file.assumptions));
  file.reader = MakeRecordReader(
      [storm = std::move(storm)](std::size_t record) { return OpenGribTime(storm, record); });
  return file;
}

}  // namespace thunderhead::storm_files
