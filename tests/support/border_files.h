// Writes coasts and borders with known lines in the layout of GSHHG's binned files, and evaluates
// maps of them.
#pragma once

#include <string>
#include <vector>

#include "glm/vec2.hpp"
#include "volume/border_map.h"

namespace thunderhead::testing {

// A segment in a bin of 10 degrees. Its points lie in the bin or on its edges. Their coordinates
// are as in the file, 65535 along each side.
struct BorderSegment {
  int bin = 0;    // 36 in a row, counted from the north and from Greenwich
  int level = 1;  // coasts: 1 sea, 2 lake, 6 grounded ice; borders: 1 country, 2 state, 3 at sea
  std::vector<glm::ivec2> points;
  double area_km2 = 1e6;    // of a coast's polygon
  int declared_points = 0;  // replaces the number of points if it is not 0
};

// Writes the set named by `letter`: f, h, i, l or c. Aborts the test program if that fails.
void WriteBorderFiles(const std::string& folder, char letter,
                      const std::vector<BorderSegment>& coasts,
                      const std::vector<BorderSegment>& borders);

// Returns the segment through places in degrees, in coordinates of the bin that contains them.
BorderSegment SegmentThrough(const std::vector<glm::dvec2>& longitudes_and_latitudes,
                             int level = 1);

// Returns the share of a small piece of ground that is painted.
float PaintedAt(const volume::BorderMap& map, const glm::dvec2& place_m);

}  // namespace thunderhead::testing
