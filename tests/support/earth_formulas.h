// Map projections of the sphere by formulas, and not by PROJ, for tests of code that uses PROJ:
// Snyder 1987 (USGS Professional Paper 1395), equations 7-4, 15-1 to 15-11, 20-14 to 20-18 and
// 21-15 to 21-18. Distances are great circles.
#pragma once

#include <cmath>
#include <numbers>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "volume/map_projection.h"

namespace thunderhead::testing {

inline constexpr double kEarth_m = 6'370'000.0;  // the radius in WRF
inline constexpr double kPi = std::numbers::pi;

inline glm::dvec3 Direction(const volume::EarthPlace& place) {
  const double latitude = glm::radians(place.latitude_deg);
  const double longitude = glm::radians(place.longitude_deg);
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
          std::sin(latitude)};
}

inline volume::EarthPlace PlaceIn(const glm::dvec3& direction) {
  return {glm::degrees(std::atan2(direction.z, std::hypot(direction.x, direction.y))),
          glm::degrees(std::atan2(direction.y, direction.x))};
}

inline double Distance_m(const volume::EarthPlace& a, const volume::EarthPlace& b) {
  return 2.0 * kEarth_m * std::asin(0.5 * glm::distance(Direction(a), Direction(b)));
}

inline double Stretched(double latitude) { return std::tan(kPi / 4.0 + latitude / 2.0); }

// A Lambert projection with one or two latitudes of true scale. The origin of its plane is the tip
// of the cone.
struct LambertFormulas {
  LambertFormulas(double first_deg, double second_deg, double meridian) : meridian_deg(meridian) {
    const double first = glm::radians(first_deg);
    const double second = glm::radians(second_deg);
    cone = first_deg == second_deg ? std::sin(first)
                                   : std::log(std::cos(first) / std::cos(second)) /
                                         std::log(Stretched(second) / Stretched(first));
    length_m = kEarth_m * std::cos(first) * std::pow(Stretched(first), cone) / cone;
  }

  // Returns the distance of a parallel from the tip.
  double FromTip_m(double latitude_deg) const {
    return length_m / std::pow(Stretched(glm::radians(latitude_deg)), cone);
  }
  // Returns the length on the map of a metre on Earth.
  double Scale(double latitude_deg) const {
    return cone * FromTip_m(latitude_deg) / (kEarth_m * std::cos(glm::radians(latitude_deg)));
  }
  glm::dvec2 PlaneOf(const volume::EarthPlace& place) const {
    const double angle =
        cone * glm::radians(std::remainder(place.longitude_deg - meridian_deg, 360.0));
    return FromTip_m(place.latitude_deg) * glm::dvec2(std::sin(angle), -std::cos(angle));
  }
  volume::EarthPlace PlaceOf(const glm::dvec2& plane_m) const {
    const double stretched = std::pow(length_m / glm::length(plane_m), 1.0 / cone);
    return {glm::degrees(2.0 * std::atan(stretched) - kPi / 2.0),
            meridian_deg + glm::degrees(std::atan2(plane_m.x, -plane_m.y) / cone)};
  }

  double meridian_deg;
  double cone = 0.0;
  double length_m = 0.0;
};

inline volume::EarthPlace FromMercator(const glm::dvec2& plane_m, double true_deg,
                                       double meridian_deg) {
  const double scale_m = kEarth_m * std::cos(glm::radians(true_deg));
  return {glm::degrees(2.0 * std::atan(std::exp(plane_m.y / scale_m)) - kPi / 2.0),
          meridian_deg + glm::degrees(plane_m.x / scale_m)};
}

inline volume::EarthPlace FromPolar(const glm::dvec2& plane_m, double true_deg,
                                    double meridian_deg) {
  const double scale_m = kEarth_m * (1.0 + std::sin(glm::radians(true_deg)));
  return {90.0 - 2.0 * glm::degrees(std::atan(glm::length(plane_m) / scale_m)),
          meridian_deg + glm::degrees(std::atan2(plane_m.x, -plane_m.y))};
}

// Returns the place of coordinates on a sphere whose north pole is at `pole`. The meridian 0 of
// that sphere runs from its pole over the geographical north pole.
inline volume::EarthPlace FromRotated(const glm::dvec2& rotated_deg,
                                      const volume::EarthPlace& pole) {
  const glm::dvec3 up = Direction(pole);
  const glm::dvec3 east = glm::normalize(glm::cross(glm::dvec3(0.0, 0.0, 1.0), up));
  const glm::dvec3 north = glm::cross(up, east);
  const glm::dvec3 at = Direction({rotated_deg.y, rotated_deg.x});
  return PlaceIn(at.x * north - at.y * east + at.z * up);
}

// Returns the place of coordinates in the stereographic projection around `middle`.
inline volume::EarthPlace FromStereographic(const glm::dvec2& plane_m,
                                            const volume::EarthPlace& middle) {
  const double c = 2.0 * std::atan(glm::length(plane_m) / (2.0 * kEarth_m));
  const glm::dvec3 up = Direction(middle);
  const glm::dvec3 east = glm::normalize(glm::cross(glm::dvec3(0.0, 0.0, 1.0), up));
  const glm::dvec3 north = glm::cross(up, east);
  if (c == 0.0) return middle;
  const glm::dvec2 way = glm::normalize(plane_m);
  return PlaceIn(std::cos(c) * up + std::sin(c) * (way.x * east + way.y * north));
}

}  // namespace thunderhead::testing
