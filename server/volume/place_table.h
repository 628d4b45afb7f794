// A table of world coordinates of places on Earth, from which a client without PROJ finds any place
// on the map of a storm. Its nodes are evenly spaced in the azimuthal equidistant projection around
// the domain's middle, on a sphere of radius 1 (Snyder 1987, Map Projections - A Working Manual,
// chapter 25). In these coordinates every map projection is smooth around the middle.
#pragma once

#include <vector>

#include "volume/map_projection.h"

namespace thunderhead::volume {

struct PlaceTable {
  int nodes = 0;           // along each side
  double reach_deg = 0.0;  // angular distance from the middle to the middle of a side
  // World coordinates of each node in metres, from west to east and then from south to north. They
  // are NaN beyond the map.
  std::vector<float> x_m;
  std::vector<float> y_m;
};

// Returns the place with the coordinates `u` (east) and `v` (north) in the azimuthal equidistant
// projection around `middle`. The coordinates are in radians.
EarthPlace PlaceAround(const EarthPlace& middle, double u, double v);

// Makes the table around `middle`. `reach_deg` is above 0 and below 180.
PlaceTable MakePlaceTable(const MapProjection& projection, const EarthPlace& middle, int nodes,
                          double reach_deg);

}  // namespace thunderhead::volume
