#include "storm_files/cf_places.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "glm/trigonometric.hpp"
#include "glm/vec2.hpp"
#include "storm_files/cf_angles.h"
#include "storm_files/cf_mapping.h"
#include "storm_files/cf_origin.h"
#include "storm_files/grid_mapping.h"
#include "storm_files/model_columns.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

using volume::EarthPlace;

constexpr double kMetresPerDegree = kCfEarthRadius_m * std::numbers::pi / 180.0;

double NormalLongitude(double degrees) { return std::remainder(degrees, 360.0); }

// Returns the vector from one place to a near one, in metres east and north.
glm::dvec2 Way_m(const EarthPlace& from, const EarthPlace& to) {
  const double latitude = glm::radians(0.5 * (from.latitude_deg + to.latitude_deg));
  return kMetresPerDegree *
         glm::dvec2(NormalLongitude(to.longitude_deg - from.longitude_deg) * std::cos(latitude),
                    to.latitude_deg - from.latitude_deg);
}

// Arrays of latitude and longitude, x fastest, in the order of the storm's axes.
struct PlaceArrays {
  std::string longitude;              // the name of the variable
  std::vector<std::string> meridian;  // a sentence about the longitudes' prime meridian, if any
  bool has_time = false;
  int columns = 0;
  int rows = 0;
  std::vector<float> latitude_deg;
  std::vector<float> longitude_deg;

  EarthPlace At(int x, int y) const {
    const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(x);
    return {latitude_deg[i], longitude_deg[i]};
  }
};

// Returns the variable with latitudes (or longitudes) on y and x, and perhaps on time. Variables
// that the field lists are preferred.
std::optional<CfVariable> FindPlaceVariable(const netcdf::NetcdfFile& file,
                                            const std::string& field, const CfDimensions& on,
                                            CfDirection direction) {
  const bool east = direction == CfDirection::kX;
  const char* const standard = east ? "longitude" : "latitude";
  const std::vector<std::string> listed = NamesIn(file.TextOrEmpty(field, "coordinates"));
  std::optional<CfVariable> found;
  for (const std::string& name : file.Variables()) {
    const CfDescription described = DescribeCf(file, name);
    if (described.standard_name.empty() ? !DirectionOf(described).has_value()
                                        : described.standard_name != standard) {
      continue;
    }
    if (!DegreesIn(described.units, direction).has_value()) continue;
    // Units without a direction, such as radians, do not tell a latitude from a longitude. Then the
    // standard name is needed.
    const bool known = described.standard_name == standard || DirectionOf(described) == direction;
    const auto variable = Arrange(file, name, on);
    if (!known || !variable.ok()) continue;
    if (variable->places[0] < 0 || variable->places[1] < 0 || variable->places[2] >= 0) continue;
    if (variable->member >= 0) continue;  // all members have the same columns
    if (variable->more != std::array<int, 3>{0, 0, 0}) continue;
    const bool is_listed = std::ranges::find(listed, name) != listed.end();
    if (!found.has_value() || is_listed) found = *variable;
    if (is_listed) break;
  }
  return found;
}

absl::StatusOr<std::optional<PlaceArrays>> ReadPlaceArrays(const netcdf::NetcdfFile& file,
                                                           const std::string& field,
                                                           const CfDimensions& dimensions,
                                                           std::size_t record, const CfAxis& x,
                                                           const CfAxis& y) {
  const auto latitude = FindPlaceVariable(file, field, dimensions, CfDirection::kY);
  const auto longitude = FindPlaceVariable(file, field, dimensions, CfDirection::kX);
  if (!latitude.has_value() || !longitude.has_value()) return std::optional<PlaceArrays>();
  PlaceArrays arrays;
  arrays.has_time = latitude->time >= 0 || longitude->time >= 0;
  arrays.columns = x.cells;
  arrays.rows = y.cells;
  const CfOrder order{{static_cast<std::size_t>(x.cells), static_cast<std::size_t>(y.cells), 1},
                      {x.reversed, y.reversed, false}};
  THUNDERHEAD_ASSIGN_OR_RETURN(arrays.latitude_deg, ReadOnAxes(file, *latitude, order, record));
  THUNDERHEAD_ASSIGN_OR_RETURN(arrays.longitude_deg, ReadOnAxes(file, *longitude, order, record));
  const auto degrees = [&](const CfVariable& variable, CfDirection direction) {
    return static_cast<float>(*DegreesIn(file.TextOrEmpty(variable.name, "units"), direction));
  };
  for (float& each : arrays.latitude_deg) each *= degrees(*latitude, CfDirection::kY);
  for (float& each : arrays.longitude_deg) each *= degrees(*longitude, CfDirection::kX);
  arrays.longitude = longitude->name;
  // Some programs write zeros for an idealised run, so arrays with a single place do not count.
  const auto [low, high] = std::ranges::minmax(arrays.latitude_deg);
  const auto [west, east] = std::ranges::minmax(arrays.longitude_deg);
  if (low == high && west == east) return std::optional<PlaceArrays>();
  for (std::size_t i = 0; i < arrays.latitude_deg.size(); ++i) {
    if (IsPlaceOnEarth(arrays.latitude_deg[i], arrays.longitude_deg[i])) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", latitude->name, " and ", longitude->name,
                     " have missing or impossible values; every column needs its place"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const LongitudeOrigin origin,
                               OriginOfLongitudes(file, field, arrays.longitude));
  for (float& each : arrays.longitude_deg) each += static_cast<float>(origin.meridian_deg);
  arrays.meridian = origin.assumptions;
  return std::optional(std::move(arrays));
}

// Sets the directions of axes that have no coordinates from the columns' places.
absl::Status OrientAxes(const netcdf::NetcdfFile& file, const PlaceArrays& arrays, CfAxis& x,
                        CfAxis& y) {
  if (x.unit != CfAxisUnit::kNone || y.unit != CfAxisUnit::kNone || x.cells < 2 || y.cells < 2) {
    return absl::OkStatus();
  }
  const glm::ivec2 at(arrays.columns / 2 - 1, arrays.rows / 2 - 1);
  const EarthPlace from = arrays.At(std::max(at.x, 0), std::max(at.y, 0));
  const glm::dvec2 along_x = Way_m(from, arrays.At(std::max(at.x, 0) + 1, std::max(at.y, 0)));
  const glm::dvec2 along_y = Way_m(from, arrays.At(std::max(at.x, 0), std::max(at.y, 0) + 1));
  const double turn = along_x.x * along_y.y - along_x.y * along_y.x;
  if (std::abs(along_x.x) >= std::abs(along_x.y)) x.reversed = along_x.x < 0.0;
  if (std::abs(along_y.y) >= std::abs(along_y.x)) y.reversed = along_y.y < 0.0;
  const bool mirrored = (turn < 0.0) != (x.reversed != y.reversed);
  if (!mirrored) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      file.Path(), ": by its longitudes the dimension ", x.dimension, " does not run east of ",
      y.dimension, "; give both dimensions a coordinate variable with the attribute axis"));
}

// Returns the columns of a grid of longitude and latitude.
absl::StatusOr<ColumnPlaces> PlacesInDegrees(const netcdf::NetcdfFile& file,
                                             const std::string& field, const CfAxis& x,
                                             const CfAxis& y, CfPlaces& described) {
  const CfMapping mapping = MappingOf(file, field, x.coordinate);
  std::string earth = mapping.exists ? EarthFigureOf(mapping.attributes) : "";
  if (earth.empty()) earth = absl::StrFormat("+R=%.10g", kCfEarthRadius_m);
  ColumnPlaces places;
  places.columns = {x.cells, y.cells};
  places.projection = absl::StrCat("+proj=longlat ", earth, " +no_defs");
  places.step = {x.Spacing(), y.Spacing()};
  places.first = glm::dvec2(x.faces.front(), y.faces.front()) + 0.5 * places.step;
  THUNDERHEAD_ASSIGN_OR_RETURN(const double meridian_deg, PrimeMeridianOf(file, mapping));
  places.first.x += meridian_deg;
  if (meridian_deg != 0.0) {
    described.assumptions.push_back(MeridianSentence(x.coordinate, mapping, meridian_deg));
  }
  return places;
}

// Reads the field's grid mapping. Axes of angles fit a rotated grid and scanning angles only, and
// axes of lengths all other maps.
absl::StatusOr<GridMapping> ReadMapping(const netcdf::NetcdfFile& file, const CfMapping& from,
                                        const CfAxis& x, const CfAxis& y) {
  const bool in_degrees = x.unit == CfAxisUnit::kDegrees;
  MappedGrid grid;
  if (in_degrees) {
    grid.middle = {x.Middle(), y.Middle()};
  } else {
    grid.unit_m = x.units_per_written;
  }
  auto mapping = ReadGridMapping(from.attributes, grid);
  if (!mapping.ok()) return BadMapping(file, from, mapping.status());
  const bool of_lengths = mapping->axes == GridAxes::kMetres;
  const bool of_rotated_degrees = mapping->axes == GridAxes::kRotatedDegrees;
  if (in_degrees ? !of_lengths : !of_rotated_degrees) return mapping;
  return BadMapping(
      file, from,
      absl::InvalidArgumentError(absl::StrCat(
          "needs coordinates ", in_degrees ? "in m or km" : "in degrees", ", and the units of ",
          x.coordinate, " are '", file.TextOrEmpty(x.coordinate, "units"), "'; correct them")));
}

// Returns the number of a mapping's units of x and y in one unit of the axes.
double UnitsOfMapping(const GridMapping& mapping, const CfAxis& axis) {
  if (axis.unit == CfAxisUnit::kMetres) return 1.0 / axis.units_per_written;
  return mapping.axes == GridAxes::kScanAngles ? std::numbers::pi / 180.0 : 1.0;
}

// Returns the columns of a grid that is even on a map.
ColumnPlaces PlacesOnMap(const GridMapping& mapping, const CfAxis& x, const CfAxis& y) {
  const double units = UnitsOfMapping(mapping, x);
  const glm::dvec2 low = glm::dvec2(x.faces.front(), y.faces.front()) * units;
  const glm::dvec2 step = glm::dvec2(x.Spacing(), y.Spacing()) * units;
  ColumnPlaces places;
  places.columns = {x.cells, y.cells};
  places.projection = mapping.projection;
  places.first = mapping.Plane_m(low + 0.5 * step);
  places.step = mapping.Plane_m(low + 1.5 * step) - places.first;
  return places;
}

// Returns the largest distance between a column's place on the map and its longitude and latitude,
// of columns all over the domain. Adds `meridian_deg` to the longitudes of `arrays` before the
// comparison. Returns nothing if a column is not on the map.
std::optional<double> Disagreement_m(const ColumnPlaces& on_map, const PlaceArrays& arrays,
                                     double meridian_deg) {
  const auto columns = ModelColumns::Of(on_map);
  if (!columns.ok()) return std::nullopt;
  constexpr int kSamples = 5;
  double largest_m = 0.0;
  for (int i = 0; i < kSamples * kSamples; ++i) {
    const glm::ivec2 at =
        (on_map.columns - 1) * glm::ivec2(i % kSamples, i / kSamples) / (kSamples - 1);
    const std::optional<EarthPlace> place = columns->PlaceAt(at);
    if (!place.has_value()) return std::nullopt;
    EarthPlace written = arrays.At(at.x, at.y);
    written.longitude_deg += meridian_deg;
    const glm::dvec2 way_m = Way_m(*place, written);
    largest_m = std::max(largest_m, std::hypot(way_m.x, way_m.y));
  }
  return largest_m;
}

absl::Status NoCoordinate(const netcdf::NetcdfFile& file, const CfAxis& axis) {
  if (!axis.counted_by.empty()) {
    const std::string units = file.TextOrEmpty(axis.counted_by, "units");
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": the coordinate ", axis.counted_by, " has ",
        units.empty() ? "no units" : absl::StrCat("units '", units, "'"),
        " and numbers the cells, so their size is not known; add its units (m, km or degrees), or "
        "longitudes and latitudes of all columns"));
  }
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": the dimension ", axis.dimension, " has no coordinate variable ",
                   axis.dimension, ", so its cells have no size; add one, in metres"));
}

// Sets the even columns, whose distances are true metres.
absl::Status MakeColumnsEven(const netcdf::NetcdfFile& file, const ColumnPlaces& columns,
                             const CfPlacing& at, CfPlaces& places) {
  absl::StatusOr<EvenColumns> even = MakeEven(columns, {.columns = at.columns});
  if (!even.ok()) return base::Annotate(even.status(), file.Path());
  places.dx_m = even->ModelSpacing_m().x;
  places.dy_m = even->ModelSpacing_m().y;
  std::ranges::copy(AssumptionsOf(*even), std::back_inserter(places.assumptions));
  places.even = std::make_shared<const EvenColumns>(*std::move(even));
  return absl::OkStatus();
}

// Returns the columns of the arrays, one by one.
ColumnPlaces PlacesOfArrays(const PlaceArrays& arrays) {
  ColumnPlaces places;
  places.columns = {arrays.columns, arrays.rows};
  places.latitude_deg = arrays.latitude_deg;
  places.longitude_deg = arrays.longitude_deg;
  places.radius_m = kCfEarthRadius_m;
  return places;
}

// Compares columns that are placed by their axes with their longitudes and latitudes. Returns
// whether they agree. `from` is the grid mapping of the axes, and `source` names what placed them.
bool AgreesWithArrays(const ColumnPlaces& by_axes, const PlaceArrays& arrays, const CfMapping& from,
                      const std::string& source, CfPlaces& places) {
  // The arrays may be rounded to single precision.
  constexpr double kRounding_m = 3.0;
  const bool in_degrees = absl::StartsWith(by_axes.projection, "+proj=longlat");
  const double unit_m = in_degrees ? kMetresPerDegree : 1.0;
  const double allowed_m = kRounding_m + 0.1 * unit_m * std::min(by_axes.step.x, by_axes.step.y);
  const auto apart_m = Disagreement_m(by_axes, arrays, 0.0);
  if (apart_m.has_value() && *apart_m <= allowed_m) return true;
  // CF does not say whether the longitudes of all columns count from the map's prime meridian.
  const double meridian_deg = PrimeMeridianOf(from.attributes).value_or(0.0);
  const auto shifted_m = Disagreement_m(by_axes, arrays, meridian_deg);
  if (shifted_m.has_value() && *shifted_m <= allowed_m) {
    places.assumptions.push_back(MeridianSentence(arrays.longitude, from, meridian_deg));
    return true;
  }
  places.assumptions.push_back(
      absl::StrCat("The places are those of the longitudes and latitudes; ", source,
                   apart_m.has_value()
                       ? absl::StrFormat(" put columns up to %.2f km from them.", 1e-3 * *apart_m)
                       : " put columns beyond the map."));
  return false;
}

// Returns the columns by the field's grid mapping, or nothing if it has none that can be used.
// Without `arrays`, a mapping that cannot be used is an error. If the mapping disagrees with
// `arrays`, they are preferred, because they give the place of each column directly.
absl::StatusOr<std::optional<ColumnPlaces>> PlacesByMapping(
    const netcdf::NetcdfFile& file, const std::string& field, const CfAxis& x, const CfAxis& y,
    const std::optional<PlaceArrays>& arrays, CfPlaces& places) {
  const CfMapping from = MappingOf(file, field, x.coordinate);
  const std::string& name = from.name;
  if (!from.exists || x.unit == CfAxisUnit::kNone) return std::optional<ColumnPlaces>();
  const auto mapping = ReadMapping(file, from, x, y);
  if (!mapping.ok() && !arrays.has_value()) return mapping.status();
  if (!mapping.ok()) {
    places.assumptions.push_back(
        absl::StrCat("The places are those of the longitudes and latitudes, because the grid "
                     "mapping ",
                     name, " cannot be used."));
    return std::optional<ColumnPlaces>();
  }
  if (mapping->axes == GridAxes::kDegrees) {  // of other coordinates than x and y
    if (!arrays.has_value()) {
      places.assumptions.push_back(absl::StrCat("The grid mapping ", name,
                                                " is one of longitudes and latitudes, so it does "
                                                "not place ",
                                                x.coordinate, " and ", y.coordinate, "."));
    }
    return std::optional<ColumnPlaces>();
  }
  const ColumnPlaces on_map = PlacesOnMap(*mapping, x, y);
  const std::size_t said = places.assumptions.size();
  if (arrays.has_value()) {
    const std::string source = absl::StrCat("the coordinates ", x.coordinate, " and ", y.coordinate,
                                            " with the grid mapping ", name);
    if (!AgreesWithArrays(on_map, *arrays, from, source, places)) {
      return std::optional<ColumnPlaces>();
    }
    if (places.assumptions.size() > said) return std::optional(on_map);
  }
  for (const std::string& sentence : mapping->assumptions) places.assumptions.push_back(sentence);
  if (const double meridian_deg = PrimeMeridianOf(from.attributes).value_or(0.0);
      meridian_deg != 0.0) {
    places.assumptions.push_back(MeridianSentence("of the map", from, meridian_deg));
  }
  return std::optional(on_map);
}

// Returns the columns by axes of longitude and latitude, or nothing if `arrays` disagree with them.
absl::StatusOr<std::optional<ColumnPlaces>> PlacesByAxes(const netcdf::NetcdfFile& file,
                                                         const std::string& field, const CfAxis& x,
                                                         const CfAxis& y,
                                                         const std::optional<PlaceArrays>& arrays,
                                                         CfPlaces& places) {
  CfPlaces described;
  THUNDERHEAD_ASSIGN_OR_RETURN(const ColumnPlaces columns,
                               PlacesInDegrees(file, field, x, y, described));
  if (arrays.has_value()) {
    const std::string source =
        absl::StrCat("the coordinates ", x.coordinate, " and ", y.coordinate);
    const CfMapping from = MappingOf(file, field, x.coordinate);
    if (!AgreesWithArrays(columns, *arrays, from, source, places)) {
      return std::optional<ColumnPlaces>();
    }
  }
  std::ranges::copy(described.assumptions, std::back_inserter(places.assumptions));
  return std::optional(columns);
}

// Sets the distances between columns whose place on Earth is not known.
absl::Status PlaceNowhere(const netcdf::NetcdfFile& file, const CfAxis& x, const CfAxis& y,
                          CfPlaces& places) {
  if (x.unit == CfAxisUnit::kNone) return NoCoordinate(file, x);
  places.dx_m = x.Spacing();
  places.dy_m = y.Spacing();
  if (x.unit == CfAxisUnit::kMetres) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(CheckAnglesHaveLength(file, x, y));
  places.dx_m *= kMetresPerDegree * std::cos(glm::radians(y.Middle()));
  places.dy_m *= kMetresPerDegree;
  places.assumptions.push_back(WhyAnglesAreNoPlace(file, x, y));
  return absl::OkStatus();
}

// Places the columns by the origin of x and y in the file's global attributes (origin_lat,
// origin_lon). Returns nothing if the file has no origin that can be used. Also returns nothing if
// `on_map`, the columns placed by a grid mapping, has its middle at the same place, because the
// grid mapping is then more accurate.
std::optional<ColumnPlaces> PlacesByOrigin(const netcdf::NetcdfFile& file, const CfAxis& x,
                                           const CfAxis& y,
                                           const std::optional<ColumnPlaces>& on_map,
                                           CfPlaces& places) {
  const std::optional<CfOrigin> origin = ReadCfOrigin(file);
  if (!origin.has_value() || x.unit != CfAxisUnit::kMetres) return std::nullopt;
  if (origin->rotation_deg != 0.0) {
    places.assumptions.push_back(absl::StrFormat(
        "The origin (origin_lat, origin_lon) is not used, because the grid is turned by %g "
        "degrees (rotation_angle).",
        origin->rotation_deg));
    return std::nullopt;
  }
  const ColumnPlaces from_origin = PlacesFromOrigin(*origin, x, y);
  if (on_map.has_value()) {
    const auto mapped = ModelColumns::Of(*on_map);
    const auto local = ModelColumns::Of(from_origin);
    const auto place = mapped.ok() ? mapped->Middle() : std::nullopt;
    const auto expected = local.ok() ? local->Middle() : std::nullopt;
    constexpr double kSame_m = 1000.0;
    if (place.has_value() && expected.has_value() &&
        GreatCircle_m(*place, *expected, kCfEarthRadius_m) < kSame_m) {
      return std::nullopt;
    }
  }
  places.assumptions.push_back(absl::StrFormat(
      "The columns are placed by the origin of x and y at %g N %g E (origin_lat, origin_lon)%s.",
      origin->place.latitude_deg, origin->place.longitude_deg,
      on_map.has_value() ? ", which the grid mapping contradicts" : ""));
  return from_origin;
}

// Adds an assumption if the field names a grid mapping that the file lacks, or names none although
// the file has one and the place is not known otherwise.
void NoteLostMapping(const netcdf::NetcdfFile& file, const std::string& field, CfPlaces& places) {
  const char* const consequence = places.even == nullptr
                                      ? "so the place on Earth is not known."
                                      : "so the places are those of the coordinates.";
  const CfMapping mapping = MappingOf(file, field, "");
  if (mapping.exists) return;
  if (!mapping.name.empty()) {
    places.assumptions.push_back(absl::StrCat("The grid mapping ", mapping.name, ", which ", field,
                                              " names, is not in the file, ", consequence));
    return;
  }
  if (places.even != nullptr) return;
  for (const std::string& variable : file.Variables()) {
    if (file.TextOrEmpty(variable, "grid_mapping_name").empty()) continue;
    places.assumptions.push_back(absl::StrCat(field, " does not name the grid mapping ", variable,
                                              " in its attribute grid_mapping, ", consequence));
    return;
  }
}

// Adds an assumption if the longitudes of all columns count from Greenwich and the grid mapping of
// x and y does not.
void NoteOtherMeridian(const netcdf::NetcdfFile& file, const std::string& field, const CfAxis& x,
                       const PlaceArrays& arrays, CfPlaces& places) {
  const CfMapping mapping = MappingOf(file, field, x.coordinate);
  const double meridian_deg = PrimeMeridianOf(mapping.attributes).value_or(0.0);
  if (meridian_deg == 0.0 || !arrays.meridian.empty()) return;
  places.assumptions.push_back(
      absl::StrFormat("The longitudes %s are taken to count from Greenwich, although the prime "
                      "meridian of the grid mapping %s is %.6g degrees east of it.",
                      arrays.longitude, mapping.name, meridian_deg));
}

absl::Status CheckSameUnits(const netcdf::NetcdfFile& file, const CfAxis& x, const CfAxis& y) {
  if (x.unit == y.unit) return absl::OkStatus();
  if (x.unit == CfAxisUnit::kNone) return NoCoordinate(file, x);
  if (y.unit == CfAxisUnit::kNone) return NoCoordinate(file, y);
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": ", x.dimension, " and ", y.dimension,
                   " are not in the same kind of unit; both need metres, or both degrees"));
}

// Returns the longitudes and latitudes of all columns. Sets the directions of axes without
// coordinates. If the axes are longitudes and latitudes themselves (`on_earth`), arrays that cannot
// be used are left out, and an assumption says so.
absl::StatusOr<std::optional<PlaceArrays>> ArraysWithAxes(const netcdf::NetcdfFile& file,
                                                          const std::string& field,
                                                          const CfDimensions& dimensions,
                                                          std::size_t record, bool on_earth,
                                                          CfAxis& x, CfAxis& y, CfPlaces& places) {
  // Arrays on a single row or column do not give its width.
  if (on_earth && std::min(x.cells, y.cells) == 1) return std::optional<PlaceArrays>();
  auto arrays = ReadPlaceArrays(file, field, dimensions, record, x, y);
  if (!arrays.ok() && on_earth) {
    places.assumptions.push_back(
        absl::StrCat("The places are those of ", x.coordinate, " and ", y.coordinate,
                     ", because the longitudes and latitudes of all columns cannot be used."));
    return std::optional<PlaceArrays>();
  }
  if (arrays.ok() && arrays->has_value() && x.unit == CfAxisUnit::kNone) {
    THUNDERHEAD_RETURN_IF_ERROR(OrientAxes(file, **arrays, x, y));
    return ReadPlaceArrays(file, field, dimensions, record, x, y);
  }
  return arrays;
}

}  // namespace

absl::StatusOr<CfPlaces> PlaceColumns(const netcdf::NetcdfFile& file, const std::string& field,
                                      const CfDimensions& dimensions, const CfPlacing& at,
                                      CfAxis& x, CfAxis& y) {
  CfPlaces places;
  THUNDERHEAD_RETURN_IF_ERROR(CheckSameUnits(file, x, y));
  const bool on_earth = AreEarthAngles(file, field, x, y);
  THUNDERHEAD_ASSIGN_OR_RETURN(
      auto arrays, ArraysWithAxes(file, field, dimensions, at.record, on_earth, x, y, places));
  if (arrays.has_value()) {
    std::ranges::copy(arrays->meridian, std::back_inserter(places.assumptions));
  }
  if (arrays.has_value() && arrays->has_time) {
    places.listed = std::make_shared<const ColumnPlaces>(PlacesOfArrays(*arrays));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(auto columns,
                               on_earth ? PlacesByAxes(file, field, x, y, arrays, places)
                                        : PlacesByMapping(file, field, x, y, arrays, places));
  if (!arrays.has_value()) {
    if (auto local = PlacesByOrigin(file, x, y, columns, places); local.has_value()) {
      columns = std::move(local);
    }
  } else if (!columns.has_value() && std::min(x.cells, y.cells) > 1) {
    columns = PlacesOfArrays(*arrays);
    NoteOtherMeridian(file, field, x, *arrays, places);
  }
  if (columns.has_value()) {
    THUNDERHEAD_RETURN_IF_ERROR(MakeColumnsEven(file, *columns, at, places));
  } else {
    THUNDERHEAD_RETURN_IF_ERROR(PlaceNowhere(file, x, y, places));
  }
  NoteLostMapping(file, field, places);
  return places;
}

absl::StatusOr<std::optional<CfPlaces>> PlaceColumnsAgain(const netcdf::NetcdfFile& file,
                                                          const std::string& field,
                                                          const CfDimensions& dimensions,
                                                          const CfPlaces& first, std::size_t record,
                                                          CfAxis x, CfAxis y) {
  if (first.listed == nullptr || first.even == nullptr || record == 0) {
    return std::optional<CfPlaces>();
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const auto arrays,
                               ReadPlaceArrays(file, field, dimensions, record, x, y));
  if (!arrays.has_value() || PlacesOfArrays(*arrays) == *first.listed) {
    return std::optional<CfPlaces>();
  }
  absl::StatusOr<CfPlaces> places =
      PlaceColumns(file, field, dimensions, {record, first.even->columns}, x, y);
  if (!places.ok()) return base::Annotate(places.status(), absl::StrCat("record ", record));
  return std::optional(*std::move(places));
}

}  // namespace thunderhead::storm_files
