// Where the sun stands in the sky at a time and place. Meeus, Astronomical Algorithms (1998),
// chapter 25 (low accuracy), with sidereal time by eq. 12.4. Within 0.01 degrees from 1950 to 2050,
// of the sun's middle as it would stand without air: refraction, up to 0.5 degrees at the horizon,
// is left out, as the storm's top is above most of the air that bends light.
#pragma once

namespace thunderhead::physics {

struct SunPosition {
  double azimuth_deg = 0.0;  // clockwise from north, 0 to 360
  double elevation_deg = 0.0;
};

// `unix_s` counts seconds of UTC since 1970; east and north are positive.
SunPosition SunPositionAt(double unix_s, double latitude_deg, double longitude_deg);

}  // namespace thunderhead::physics
