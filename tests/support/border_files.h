// Writes coasts and borders in the layout of GSHHG's binned files, with known lines; and looks at
// maps of them.
#pragma once

#include <string>
#include <vector>

#include "glm/vec2.hpp"
#include "volume/border_map.h"

namespace thunderhead::testing {

// Bins of 10 degrees. Points of a segment lie in one bin or on its edges, in its coordinates as the
// file has them: 65535 along each side.
struct BorderSegment {
  int bin = 0;    // 36 in a row, from the north and from Greenwich
  int level = 1;  // coasts: 1 sea, 2 lake, 6 grounded ice; borders: 1 country, 2 state, 3 at sea
  std::vector<glm::ivec2> points;
  double area_km2 = 1e6;    // of a coast's polygon
  int declared_points = 0;  // in place of the number of points
};

// `letter` is the set's: f, h, i, l or c. Aborts the test program if that fails.
void WriteBorderFiles(const std::string& folder, char letter,
                      const std::vector<BorderSegment>& coasts,
                      const std::vector<BorderSegment>& borders);

// The coordinates of a place in degrees, and the bin that holds it.
BorderSegment SegmentThrough(const std::vector<glm::dvec2>& longitudes_and_latitudes,
                             int level = 1);

// The share of a small piece of ground that is painted.
float PaintedAt(const volume::BorderMap& map, const glm::dvec2& place_m);

}  // namespace thunderhead::testing
