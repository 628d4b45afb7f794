#include "storm_files/grib_columns.h"

#include <cmath>
#include <optional>

#include "absl/strings/match.h"
#include "base/status.h"
#include "glm/trigonometric.hpp"
#include "storm_files/model_columns.h"

namespace thunderhead::storm_files {

ColumnPlaces PlacesOf(const grib::Grid& grid) {
  ColumnPlaces places;
  places.columns = {grid.columns, grid.rows};
  places.projection = grid.projection;
  places.first = grid.south_west;
  places.step = grid.step;
  return places;
}

absl::StatusOr<std::vector<float>> AxisAngles(const grib::Grid& grid) {
  std::vector<float> angles;
  if (absl::StartsWith(grid.projection, "+proj=longlat")) return angles;
  THUNDERHEAD_ASSIGN_OR_RETURN(const ModelColumns columns, ModelColumns::Of(PlacesOf(grid)));
  angles.reserve(grid.Points());
  constexpr double kHalf = 0.005;  // half the distance, in columns, between the compared places
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto from = columns.PlaceAt({column - kHalf, row});
      const auto to = columns.PlaceAt({column + kHalf, row});
      if (!from.has_value() || !to.has_value()) {
        return absl::InvalidArgumentError("columns lie beyond the edge of their map projection");
      }
      const double north = to->latitude_deg - from->latitude_deg;
      const double east = std::remainder(to->longitude_deg - from->longitude_deg, 360.0) *
                          std::cos(glm::radians(from->latitude_deg));
      angles.push_back(static_cast<float>(std::atan2(north, east)));
    }
  }
  return angles;
}

}  // namespace thunderhead::storm_files
