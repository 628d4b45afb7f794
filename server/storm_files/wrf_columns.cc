#include "storm_files/wrf_columns.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "storm_files/model_columns.h"
#include "storm_files/wrf_place.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

constexpr double kEarth_m = 6'370'000.0;  // the radius of WRF's Earth
// The length over which a distance between places stored as floats, which are known to a metre, is
// accurate to 0.1 %.
constexpr double kLeastLength_m = 2000.0;

// Reads one value a column, or nothing if the variable has another shape.
absl::StatusOr<std::vector<float>> ReadColumns(const netcdf::NetcdfFile& file,
                                               const std::string& variable,
                                               const glm::ivec2& columns, std::size_t record) {
  const std::vector<std::size_t> expected = {static_cast<std::size_t>(columns.y),
                                             static_cast<std::size_t>(columns.x)};
  const absl::StatusOr<std::vector<std::size_t>> shape = file.Shape(variable);
  if (!shape.ok() || shape->size() < 2 || shape->size() > 3) return std::vector<float>();
  if (!std::equal(expected.begin(), expected.end(), shape->end() - 2)) return std::vector<float>();
  if (shape->size() == 2) return file.ReadPart(variable, {0, 0}, expected);
  if (record >= shape->front()) return std::vector<float>();
  return file.ReadPart(variable, {record, 0, 0}, {1, expected[0], expected[1]});
}

// Returns the columns as even steps in the projection, or nothing if the places disagree with it.
std::optional<ColumnPlaces> InProjection(const ColumnPlaces& listed,
                                         const std::string& projection) {
  const absl::StatusOr<volume::MapProjection> map = volume::MapProjection::Open(projection);
  if (projection.empty() || !map.ok()) return std::nullopt;
  const glm::ivec2 last = listed.columns - 1;
  const auto place = [&](int x, int y) {
    const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(listed.columns.x) +
                   static_cast<std::size_t>(x);
    return volume::EarthPlace{listed.latitude_deg[i], listed.longitude_deg[i]};
  };
  const auto plane = [&](int x, int y) {
    return map->WorldOf(place(x, y)).value_or(glm::dvec2(std::nan("")));
  };
  const glm::dvec2 first = plane(0, 0);
  ColumnPlaces found;
  found.columns = listed.columns;
  found.projection = projection;
  found.first = first;
  found.step = {(plane(last.x, 0) - first).x / last.x, (plane(0, last.y) - first).y / last.y};
  if (!(found.step.x > 0.0) || !(found.step.y > 0.0)) return std::nullopt;
  // The corners and some columns between them are compared.
  constexpr int kCompared = 5;
  constexpr double kRounding_m = 2.0;
  const double allowed_m = kRounding_m + 0.02 * std::min(found.step.x, found.step.y);
  for (int j = 0; j < kCompared; ++j) {
    for (int i = 0; i < kCompared; ++i) {
      const glm::ivec2 at = last * glm::ivec2(i, j) / (kCompared - 1);
      const std::optional<volume::EarthPlace> computed =
          map->PlaceOf(first + glm::dvec2(at) * found.step);
      if (!computed.has_value() ||
          !(GreatCircle_m(*computed, place(at.x, at.y), kEarth_m) <= allowed_m)) {
        return std::nullopt;
      }
    }
  }
  return found;
}

// Returns whether the domain is long enough, along both axes, for its places to give its size.
// Returns true if a place is missing, because that is reported as an error later.
bool IsMeasurable(const ColumnPlaces& listed) {
  const auto place = [&](std::size_t i) {
    return volume::EarthPlace{listed.latitude_deg[i], listed.longitude_deg[i]};
  };
  const auto width = static_cast<std::size_t>(listed.columns.x);
  const std::size_t last_row = listed.latitude_deg.size() - width;
  return !(GreatCircle_m(place(0), place(width - 1), kEarth_m) < kLeastLength_m) &&
         !(GreatCircle_m(place(0), place(last_row), kEarth_m) < kLeastLength_m);
}

// Returns the mean of a variable over all columns at the first time. It is NaN if the file has no
// such variable, or if the mean is not above 0.
absl::StatusOr<double> MeanOf(const netcdf::NetcdfFile& file, const std::string& variable,
                              const glm::ivec2& columns) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> values,
                               ReadColumns(file, variable, columns, 0));
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  const double mean = sum / static_cast<double>(values.size());
  return mean > 0.0 && std::isfinite(mean) ? mean : std::nan("");
}

// Returns the scale of a conformal projection in PROJ's notation. It is measured along a meridian.
std::optional<double> ScaleAt(const std::string& projection, const volume::EarthPlace& place) {
  constexpr double kHalfStep_deg = 0.005;
  const absl::StatusOr<volume::MapProjection> map = volume::MapProjection::Open(projection);
  if (projection.empty() || !map.ok()) return std::nullopt;
  volume::EarthPlace south = place;
  volume::EarthPlace north = place;
  south.latitude_deg = std::max(place.latitude_deg - kHalfStep_deg, -90.0);
  north.latitude_deg = std::min(place.latitude_deg + kHalfStep_deg, 90.0);
  const std::optional<glm::dvec2> low_m = map->WorldOf(south);
  const std::optional<glm::dvec2> high_m = map->WorldOf(north);
  if (!low_m.has_value() || !high_m.has_value()) return std::nullopt;
  const double scale = glm::distance(*low_m, *high_m) / GreatCircle_m(south, north, kEarth_m);
  return scale > 0.0 && std::isfinite(scale) ? std::optional(scale) : std::nullopt;
}

// Returns the map factors of the file's projection at a latitude. All of WRF's projections but the
// grid of latitudes and longitudes are conformal, and their scale does not depend on longitude.
std::optional<glm::dvec2> FactorsAt(const netcdf::NetcdfFile& file, double latitude_deg) {
  constexpr double kLatitudesAndLongitudes = 6.0;
  const auto number = [&](const char* name) { return file.NumberAttribute("", name); };
  if (!(std::abs(latitude_deg) < 90.0)) return std::nullopt;
  if (number("MAP_PROJ") == kLatitudesAndLongitudes) {
    // If the pole is rotated, the latitude in the grid is not known.
    if (number("POLE_LAT").value_or(90.0) != 90.0) return std::nullopt;
    return glm::dvec2(1.0 / std::cos(glm::radians(latitude_deg)), 1.0);
  }
  const std::optional<double> scale =
      ScaleAt(WrfProjectionOf(file), {latitude_deg, number("STAND_LON").value_or(0.0)});
  return scale.has_value() ? std::optional(glm::dvec2(*scale)) : std::nullopt;
}

std::string FactorsAsText(const glm::dvec2& factors) {
  const std::string x = absl::StrFormat("%.4g", factors.x);
  const std::string y = absl::StrFormat("%.4g", factors.y);
  return x == y ? absl::StrCat("map factor ", x)
                : absl::StrCat("map factors ", x, " along x and ", y, " along y");
}

}  // namespace

absl::StatusOr<std::optional<ColumnPlaces>> ReadWrfColumns(const netcdf::NetcdfFile& file,
                                                           const WrfColumnNames& names,
                                                           const glm::ivec2& columns,
                                                           std::size_t record) {
  ColumnPlaces listed;
  listed.columns = columns;
  listed.radius_m = kEarth_m;
  if (std::min(columns.x, columns.y) < 2) return std::nullopt;
  THUNDERHEAD_ASSIGN_OR_RETURN(listed.latitude_deg,
                               ReadColumns(file, names.latitude, columns, record));
  THUNDERHEAD_ASSIGN_OR_RETURN(listed.longitude_deg,
                               ReadColumns(file, names.longitude, columns, record));
  if (listed.latitude_deg.empty() || listed.longitude_deg.empty() || !IsMeasurable(listed)) {
    return std::nullopt;
  }
  if (std::optional<ColumnPlaces> even = InProjection(listed, names.projection); even.has_value()) {
    return even;
  }
  return listed;
}

absl::StatusOr<std::optional<WrfMapFactors>> FindMapFactors(
    const netcdf::NetcdfFile& file, const glm::ivec2& columns,
    const std::optional<volume::EarthPlace>& middle) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const double for_all, MeanOf(file, "MAPFAC_M", columns));
  glm::dvec2 means(for_all);
  for (const int axis : {0, 1}) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const double mean,
                                 MeanOf(file, axis == 0 ? "MAPFAC_MX" : "MAPFAC_MY", columns));
    if (!std::isnan(mean)) means[axis] = mean;
  }
  if (!std::isnan(means.x) && !std::isnan(means.y)) {
    return WrfMapFactors{means, absl::StrCat("the mean ", FactorsAsText(means))};
  }
  const std::optional<double> centre_deg = file.NumberAttribute("", "CEN_LAT");
  if (!middle.has_value() && !centre_deg.has_value()) return std::nullopt;
  const double latitude_deg = middle.has_value() ? middle->latitude_deg : *centre_deg;
  const std::optional<glm::dvec2> factors = FactorsAt(file, latitude_deg);
  if (!factors.has_value()) return std::nullopt;
  return WrfMapFactors{
      *factors, absl::StrFormat("the %s, which the projection has at %.4g degrees north (%s)",
                                FactorsAsText(*factors), latitude_deg,
                                middle.has_value() ? "the middle of the domain" : "CEN_LAT")};
}

}  // namespace thunderhead::storm_files
