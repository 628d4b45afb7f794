#include "reference/near_sun.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "physics/atmosphere.h"

namespace thunderhead::reference {

std::vector<bool> NearSun(const Camera& camera, const glm::dvec3& towards_sun,
                          const glm::ivec2& size_px, double peak_cut_deg) {
  const double apart_rad = std::max(glm::radians(peak_cut_deg), physics::kSunRadius_rad);
  // Length of the difference of two unit vectors at this angle.
  const double apart = 2.0 * std::sin(0.5 * apart_rad);
  const auto towards = [&](double x_px, double y_px) {
    return camera.RayThrough(2.0 * x_px / size_px.x - 1.0, 1.0 - 2.0 * y_px / size_px.y).direction;
  };
  std::vector<bool> near;
  near.reserve(static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y));
  for (int y = 0; y < size_px.y; ++y) {
    for (int x = 0; x < size_px.x; ++x) {
      const glm::dvec3 middle = towards(x + 0.5, y + 0.5);
      const double reach = apart + glm::length(middle - towards(x, y));
      near.push_back(glm::length(middle - towards_sun) < reach);
    }
  }
  return near;
}

}  // namespace thunderhead::reference
