// The air that a storm's mixing ratios refer to. Only masses per volume are kept cell by cell; the
// density by which they were multiplied is smooth, so means over blocks of columns bring the ratios
// back. Knows no files.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "volume/grid.h"

namespace thunderhead::volume {

// Along each axis; at most one a column.
inline constexpr int kAirBlocks = 16;

// Densities on the storm's grid; between the middles of blocks they are linear.
struct AirDensity {
  glm::ivec2 blocks{0};
  std::vector<float> kg_per_m3;  // a value a block and level, x fastest; empty if nothing tells

  bool Empty() const { return kg_per_m3.empty(); }
  // At the middle of column (x, y), level z; above 0 unless it is empty, which is 0.
  float At(const RegularGrid& grid, int x, int y, int z) const;
};

// Means of samples. A level without any has the density of the nearest one with some, as below
// mountains.
class AirDensityMeans {
 public:
  explicit AirDensityMeans(const RegularGrid& grid);

  // The steps along each axis between columns that are enough for the mean.
  glm::ivec2 Stride() const;

  // Air of this density in column (x, y) from a height to another; NaN is left out.
  void Add(int x, int y, double bottom_m, double top_m, float density_kg_per_m3);

  AirDensity Means() const;

 private:
  std::size_t Offset(const glm::ivec2& block, int z) const;

  const RegularGrid grid_;
  glm::ivec2 blocks_;
  std::vector<double> sums_;
  std::vector<double> weights_;
};

}  // namespace thunderhead::volume
