// The air that a storm's mixing ratios refer to. Only masses per volume are kept cell by cell. The
// air density by which the mixing ratios were multiplied is smooth, so block means of it recover
// the ratios. This code does not depend on files.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "volume/grid.h"

namespace thunderhead::volume {

// Number of blocks along each axis. There is at most one for each column.
inline constexpr int kAirBlocks = 16;

// Air densities on the storm's grid. They are linear between the centres of blocks.
struct AirDensity {
  glm::ivec2 blocks{0};
  std::vector<float> kg_per_m3;  // one value for each block and level, x fastest; empty if unknown

  bool Empty() const { return kg_per_m3.empty(); }
  // Returns the density at the centre of column (x, y), level z. It is above 0, or 0 if Empty().
  float At(const RegularGrid& grid, int x, int y, int z) const;
};

// Computes means of samples. A level without samples gets the density of the next level below that
// has samples. If there is none, for example inside mountains, it gets that of the next above.
class AirDensityMeans {
 public:
  explicit AirDensityMeans(const RegularGrid& grid);

  // Returns the step along each axis between the columns that need to be sampled.
  glm::ivec2 Stride() const;

  // Adds air of this density in column (x, y) between two heights. NaN is ignored.
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
