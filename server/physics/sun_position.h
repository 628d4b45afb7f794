// The position of the sun in the sky at a time and place. The method is that of Meeus, Astronomical
// Algorithms (1998), chapter 25 (low accuracy), with sidereal time by eq. 12.4. The error is within
// 0.01 degrees from 1950 to 2050. The position is that of the disc's centre without air.
// Refraction, up to 0.5 degrees at the horizon, is neglected, because the storm's top is above most
// of the refracting air.
#pragma once

namespace thunderhead::physics {

struct SunPosition {
  double azimuth_deg = 0.0;  // clockwise from north, 0 to 360
  double elevation_deg = 0.0;
};

// Returns the position. `unix_s` counts seconds of UTC since 1970. East and north are positive.
SunPosition SunPositionAt(double unix_s, double latitude_deg, double longitude_deg);

}  // namespace thunderhead::physics
