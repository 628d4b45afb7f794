// A map of the coastlines and borders on the ground of a storm whose place on Earth is known. It
// stores each texel's offset from the nearest line. Linear interpolation of such offsets is exact
// next to a straight line. Lines can therefore be drawn much thinner than a texel, with one texture
// fetch. This code does not depend on files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec4.hpp"

namespace thunderhead::volume {

struct BorderLine {
  std::vector<glm::dvec2> points_m;  // points of the line, in world metres
  float strength = 1.0F;             // share of the ground's colour that the line's colour replaces
};

// A grid of square texels over a part of the horizontal world plane.
struct BorderGrid {
  glm::dvec2 low_m{0.0};
  double texel_m = 0.0;
  glm::ivec2 texels{0};
  double fades_m = 0.0;  // lines fade out within this distance of the grid's edge
};

struct BorderMap {
  BorderGrid grid;
  // For each texel, x fastest, four halves (glm::packHalf4x16). They are the x and y offset of the
  // texel's centre from the nearest point on a line, the length of that offset, and the line's
  // strength. Offset and length are in texels. The strength is 0 in the outermost texels. The array
  // is empty if there are no lines.
  std::vector<std::uint64_t> nearest;

  std::size_t Bytes() const { return nearest.size() * sizeof(std::uint64_t); }
};

BorderMap MakeBorderMap(const std::vector<BorderLine>& lines, const BorderGrid& grid);

// Returns the four values of BorderMap::nearest at a place in world metres, interpolated linearly
// between texels. Beyond the map's edge it returns the values at the nearest point of the edge. The
// map must not be empty.
glm::vec4 NearestBorder(const BorderMap& map, const glm::dvec2& place_m);

}  // namespace thunderhead::volume
