#include "volume/place_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glm/trigonometric.hpp"

namespace thunderhead::volume {

EarthPlace PlaceAround(const EarthPlace& middle, double u, double v) {
  const double distance = std::hypot(u, v);
  if (distance == 0.0) return middle;
  const double latitude = glm::radians(middle.latitude_deg);
  const double sine = std::sin(distance);
  const double cosine = std::cos(distance);
  // The components of the place's direction along the north pole, and along the equator towards and
  // across the middle's meridian.
  const double up = cosine * std::sin(latitude) + v / distance * sine * std::cos(latitude);
  const double towards = cosine * std::cos(latitude) - v / distance * sine * std::sin(latitude);
  const double across = u / distance * sine;
  return {glm::degrees(std::asin(std::clamp(up, -1.0, 1.0))),
          std::remainder(middle.longitude_deg + glm::degrees(std::atan2(across, towards)), 360.0)};
}

PlaceTable MakePlaceTable(const MapProjection& projection, const EarthPlace& middle, int nodes,
                          double reach_deg) {
  PlaceTable table{.nodes = nodes, .reach_deg = reach_deg, .x_m = {}, .y_m = {}};
  const auto at = [&](int index) {
    return glm::radians(reach_deg) * (2.0 * index / (nodes - 1) - 1.0);
  };
  constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
  for (int row = 0; row < nodes; ++row) {
    for (int column = 0; column < nodes; ++column) {
      const std::optional<glm::dvec2> world_m =
          projection.WorldOf(PlaceAround(middle, at(column), at(row)));
      table.x_m.push_back(world_m.has_value() ? static_cast<float>(world_m->x) : kNowhere);
      table.y_m.push_back(world_m.has_value() ? static_cast<float>(world_m->y) : kNowhere);
    }
  }
  return table;
}

}  // namespace thunderhead::volume
