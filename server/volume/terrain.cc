#include "volume/terrain.h"

#include <algorithm>

#include "glm/common.hpp"

namespace thunderhead::volume {

double TerrainHeight_m(const HydrometeorFields& fields, const glm::dvec2& place_m) {
  const RegularGrid& grid = fields.grid;
  if (fields.terrain_height_m.empty()) return grid.low_corner_m.z;
  const glm::dvec2 last(glm::ivec2(grid.cells) - 1);
  const glm::dvec2 column =
      glm::clamp((place_m - glm::dvec2(grid.low_corner_m)) / glm::dvec2(grid.spacing_m) - 0.5,
                 glm::dvec2(0.0), last);
  const glm::ivec2 low = glm::min(glm::ivec2(column), glm::max(glm::ivec2(last) - 1, 0));
  const glm::ivec2 high = glm::min(low + 1, glm::ivec2(last));
  const glm::dvec2 share = column - glm::dvec2(low);
  const auto height_m = [&](int x, int y) -> double {
    return fields.terrain_height_m[grid.Offset(x, y, 0)];
  };
  return glm::mix(glm::mix(height_m(low.x, low.y), height_m(high.x, low.y), share.x),
                  glm::mix(height_m(low.x, high.y), height_m(high.x, high.y), share.x), share.y);
}

double LowestTerrain_m(const HydrometeorFields& fields) {
  if (fields.terrain_height_m.empty()) return fields.grid.low_corner_m.z;
  return *std::min_element(fields.terrain_height_m.begin(), fields.terrain_height_m.end());
}

}  // namespace thunderhead::volume
