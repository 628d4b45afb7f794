#include "volume/coarsen.h"

#include "glm/common.hpp"

namespace thunderhead::volume {
namespace {

std::vector<float> BlockMeans(const RegularGrid& fine, const RegularGrid& coarse,
                              const glm::ivec3& factor, const std::vector<float>& values) {
  std::vector<float> means(coarse.CellCount(), 0.0F);
  const float share = 1.0F / static_cast<float>(factor.x * factor.y * factor.z);
  for (int z = 0; z < fine.cells.z; ++z) {
    for (int y = 0; y < fine.cells.y; ++y) {
      const float* from = values.data() + fine.Offset(0, y, z);
      float* to = means.data() + coarse.Offset(0, y / factor.y, z / factor.z);
      for (int x = 0; x < fine.cells.x; ++x) to[x / factor.x] += from[x] * share;
    }
  }
  return means;
}

}  // namespace

glm::ivec3 CoarseningFor(const HydrometeorFields& fields, int max_cells) {
  if (fields.condensate.Empty()) return glm::ivec3(1);
  // Reserves cells for a border on either side, and for blocks that the condensate fills in part.
  const glm::ivec3 extent = fields.condensate.high - fields.condensate.low;
  const glm::ivec3 room(max_cells - 4);
  const glm::ivec3 fits = glm::min(extent + 2, fields.grid.cells);
  glm::ivec3 factor(1);
  for (int axis = 0; axis < 3; ++axis) {
    if (fits[axis] > max_cells) factor[axis] = (extent[axis] + room[axis] - 1) / room[axis];
  }
  return factor;
}

HydrometeorFields Coarsened(const HydrometeorFields& fields, const glm::ivec3& factor) {
  HydrometeorFields coarse;
  coarse.grid.cells = (fields.grid.cells + factor - 1) / factor;
  coarse.grid.spacing_m = fields.grid.spacing_m * glm::dvec3(factor);
  coarse.grid.low_corner_m = fields.grid.low_corner_m;
  for (const HydrometeorField& field : fields.fields) {
    HydrometeorField& mean = coarse.fields.emplace_back();
    mean.hydrometeor = field.hydrometeor;
    mean.variable = field.variable;
    mean.quantity = field.quantity;
    if (field.concentration_kg_per_m3.empty()) continue;
    mean.concentration_kg_per_m3 =
        BlockMeans(fields.grid, coarse.grid, factor, field.concentration_kg_per_m3);
    if (field.sizes.Empty()) continue;
    mean.sizes =
        SizesOf(field.sizes, mean.concentration_kg_per_m3,
                BlockMeans(fields.grid, coarse.grid, factor, ConcentrationPerRadius(field)));
  }
  coarse.motion = fields.motion;
  for (std::vector<std::uint8_t>* values : {&coarse.motion.turbulence, &coarse.motion.ascent}) {
    if (values->empty()) continue;
    const std::vector<float> means = BlockMeans(fields.grid, coarse.grid, factor,
                                                std::vector<float>(values->begin(), values->end()));
    values->assign(means.begin(), means.end());
  }
  if (!fields.condensate.Empty()) {
    coarse.condensate = {fields.condensate.low / factor,
                         (fields.condensate.high + factor - 1) / factor};
  }
  return coarse;
}

}  // namespace thunderhead::volume
