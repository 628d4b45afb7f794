#include "physics/sun_position.h"

#include <algorithm>
#include <cmath>

#include "glm/trigonometric.hpp"

namespace thunderhead::physics {
namespace {

// Equatorial coordinates of the sun.
struct Equatorial {
  double right_ascension = 0.0;  // both angles are in radians
  double declination = 0.0;
};

// Return the sine and cosine of an angle in degrees. The loss of precision for large angles does
// not matter here.
double Sin(double degrees) { return std::sin(glm::radians(degrees)); }
double Cos(double degrees) { return std::cos(glm::radians(degrees)); }

// Returns the apparent position of the sun. `t` is in Julian centuries since 2000 January 1, 12 h.
// UTC is used in place of dynamical time. The difference of about a minute moves the sun by 0.0007
// degrees.
Equatorial ApparentSun(double t) {
  const double mean_longitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
  const double anomaly = 357.52911 + t * (35999.05029 - t * 0.0001537);
  const double center = (1.914602 - t * (0.004817 + t * 0.000014)) * Sin(anomaly) +
                        (0.019993 - t * 0.000101) * Sin(2.0 * anomaly) +
                        0.000289 * Sin(3.0 * anomaly);
  const double node = 125.04 - 1934.136 * t;  // node of the moon's orbit, for nutation
  const double longitude = mean_longitude + center - 0.00569 - 0.00478 * Sin(node);
  const double obliquity = 23.439291 - t * 0.0130042 + 0.00256 * Cos(node);
  return {std::atan2(Cos(obliquity) * Sin(longitude), Cos(longitude)),
          std::asin(std::clamp(Sin(obliquity) * Sin(longitude), -1.0, 1.0))};
}

}  // namespace

SunPosition SunPositionAt(double unix_s, double latitude_deg, double longitude_deg) {
  const double days = unix_s / 86400.0 - 10957.5;  // days since 2000 January 1, 12 h
  const double t = days / 36525.0;
  const Equatorial sun = ApparentSun(t);
  const double sidereal_deg = 280.46061837 + 360.98564736629 * days + t * t * 0.000387933;
  const double hour_angle =
      glm::radians(std::fmod(sidereal_deg + longitude_deg, 360.0)) - sun.right_ascension;
  const double latitude = glm::radians(latitude_deg);
  const double sine = std::sin(latitude) * std::sin(sun.declination) +
                      std::cos(latitude) * std::cos(sun.declination) * std::cos(hour_angle);
  const double east = -std::cos(sun.declination) * std::sin(hour_angle);
  const double north = std::cos(latitude) * std::sin(sun.declination) -
                       std::sin(latitude) * std::cos(sun.declination) * std::cos(hour_angle);
  const double azimuth_deg = glm::degrees(std::atan2(east, north));
  return {azimuth_deg < 0.0 ? azimuth_deg + 360.0 : azimuth_deg,
          glm::degrees(std::asin(std::clamp(sine, -1.0, 1.0)))};
}

}  // namespace thunderhead::physics
