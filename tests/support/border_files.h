// Writes files of coasts and borders with known lines, in the layout of GSHHG's binned files. Also
// evaluates border maps that were made from such files.
#pragma once

#include <string>
#include <vector>

#include "glm/vec2.hpp"
#include "volume/border_map.h"

namespace thunderhead::testing {

// A line segment in one bin, a square of 10 x 10 degrees. Its points lie in the bin or on its
// edges. Their coordinates are as in the file, from 0 to 65535 along each side of the bin.
struct BorderSegment {
  // Number of the bin: 36 bins in a row, counted eastwards from Greenwich; rows are counted from
  // the north.
  int bin = 0;
  // For a coast: 1 sea, 2 lake, 6 grounded ice. For a border: 1 country, 2 state, 3 at sea.
  int level = 1;
  std::vector<glm::ivec2> points;
  double area_km2 = 1e6;    // area of the polygon to which a coast belongs
  int declared_points = 0;  // number of points that the file declares; 0: the actual number
};

// Writes the files of one resolution, named by `letter`: f, h, i, l or c. Aborts the test program
// if writing fails.
void WriteBorderFiles(const std::string& folder, char letter,
                      const std::vector<BorderSegment>& coasts,
                      const std::vector<BorderSegment>& borders);

// Returns the segment through these places (longitude and latitude in degrees), in coordinates of
// the bin that contains the places.
BorderSegment SegmentThrough(const std::vector<glm::dvec2>& longitudes_and_latitudes,
                             int level = 1);

// Returns the fraction, from 0 to 1, of a small piece of ground at `place_m` that the map's lines
// cover.
float PaintedAt(const volume::BorderMap& map, const glm::dvec2& place_m);

}  // namespace thunderhead::testing
