#include "storm_files/wrf_columns.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "storm_files/model_columns.h"
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

absl::StatusOr<double> ReadMeanMapFactor(const netcdf::NetcdfFile& file,
                                         const glm::ivec2& columns) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<float> factors,
                               ReadColumns(file, "MAPFAC_M", columns, 0));
  double sum = 0.0;
  for (const float factor : factors) sum += factor;
  const double mean = sum / static_cast<double>(std::max<std::size_t>(factors.size(), 1));
  return mean > 0.0 && std::isfinite(mean) ? mean : 1.0;
}

}  // namespace thunderhead::storm_files
