// Coasts and borders on the ground of a storm with a place on Earth, as a map of offsets from the
// nearest line: a linear mean of such offsets is exact beside a straight line, so that lines are
// drawn much thinner than a texel, with one fetch of a texture. Knows no file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec4.hpp"

namespace thunderhead::volume {

struct BorderLine {
  std::vector<glm::dvec2> points_m;  // world metres
  float strength = 1.0F;             // share of the ground that it paints over
};

// Square texels over a part of the world's plane.
struct BorderGrid {
  glm::dvec2 low_m{0.0};
  double texel_m = 0.0;
  glm::ivec2 texels{0};
  double fades_m = 0.0;  // towards its edge lines vanish within this distance
};

struct BorderMap {
  BorderGrid grid;
  // For each texel, x fastest, four halves (glm::packHalf4x16): its middle less the nearest point
  // on a line, x and y, the distance, both in texels, and the line's strength, 0 in the outermost
  // texels. Empty if there are no lines.
  std::vector<std::uint64_t> nearest;

  std::size_t Bytes() const { return nearest.size() * sizeof(std::uint64_t); }
};

BorderMap MakeBorderMap(const std::vector<BorderLine>& lines, const BorderGrid& grid);

// The values at a place in world metres, linear between texels and those of the edge beyond it. The
// map is not empty.
glm::vec4 NearestBorder(const BorderMap& map, const glm::dvec2& place_m);

}  // namespace thunderhead::volume
