// The density of the air to which a storm's mixing ratios refer. A storm in memory stores only mass
// per volume for each cell. Air density is smooth, so means over blocks of columns are enough to
// compute the mixing ratios again. This code does not depend on files.
#pragma once

#include <vector>

#include "glm/vec2.hpp"
#include "volume/grid.h"

namespace thunderhead::volume {

// The number of blocks of columns along x and along y. A grid with fewer columns has one block for
// each column.
inline constexpr int kAirBlocks = 16;

// Air densities as means over blocks of columns, at each level of the storm's grid. Between the
// centres of blocks the density is interpolated linearly.
struct AirDensity {
  glm::ivec2 blocks{0};
  std::vector<float> kg_per_m3;  // one value for each block and level, x fastest; empty if unknown

  bool Empty() const { return kg_per_m3.empty(); }
  // Returns the density at the centre of column (x, y), level z. The density is greater than 0,
  // except that it is 0 if Empty().
  float At(const RegularGrid& grid, int x, int y, int z) const;
};

// Computes means of samples. A level without samples gets the density of the next level below that
// has samples. If there is none, for example inside mountains, it gets that of the next above.
class AirDensityMeans {
 public:
  explicit AirDensityMeans(const RegularGrid& grid);

  // Returns the distance, in columns along x and y, between the columns that the caller should
  // sample.
  glm::ivec2 Stride() const;

  // Adds a sample: the density of the air in column (x, y) between two heights. Samples with NaN
  // are ignored.
  void Add(int x, int y, double bottom_m, double top_m, float density_kg_per_m3);

  // Returns the means, or an empty AirDensity if a block has no samples.
  AirDensity Means() const;

 private:
  std::size_t Offset(const glm::ivec2& block, int z) const;

  const RegularGrid grid_;
  glm::ivec2 blocks_;
  std::vector<double> sums_;
  std::vector<double> weights_;
};

}  // namespace thunderhead::volume
