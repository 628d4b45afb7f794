#include "storm_files/field_scan.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "glm/common.hpp"

namespace thunderhead::storm_files {
namespace {

constexpr float kSmallestNormal = std::numeric_limits<float>::min();

// Advection schemes produce small negative values, of about -1e-13. Values below this limit are
// codes for "missing", such as -999.
constexpr float kMinAmount = -0.5F;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct ScanRange {
  float minimum = kInfinity;
  float maximum = -kInfinity;
};

// Converts the `values` of one level in place, and adds each cell's mass per area to its column's
// `water_path`. `density` points to the level's densities.
void ScanLevel(const LayerAir& air, int level, const float* density, float* values,
               volume::FieldStatistics& statistics, ScanRange& range,
               std::vector<double>& water_path) {
  const std::size_t offset = level * air.columns;
  const float* bottom_m = air.interface_height_m.data() + offset;
  const float* top_m = bottom_m + air.columns;
  std::int64_t missing_cells = 0;
  std::int64_t negative_cells = 0;
  for (std::size_t i = 0; i < air.columns; ++i) {
    const float value = values[i];
    // All comparisons fail for NaN, so NaN counts as missing.
    const bool present = value > kMinAmount && value < kInfinity && density[i] > 0.0F;
    missing_cells += present ? 0 : 1;
    negative_cells += present && value < 0.0F ? 1 : 0;
    range.minimum = present ? std::min(range.minimum, value) : range.minimum;
    range.maximum = present ? std::max(range.maximum, value) : range.maximum;
    const float product = present ? value * density[i] : 0.0F;
    const float concentration = product >= kSmallestNormal ? product : 0.0F;
    values[i] = concentration;
    if (concentration > 0.0F) {
      water_path[i] += static_cast<double>(concentration) * (top_m[i] - bottom_m[i]);
    }
  }
  statistics.missing_cells += missing_cells;
  statistics.negative_cells += negative_cells;
}

// Returns a density of 1 for each column of the level, or 0 where the level has no thickness.
std::vector<float> OneWhereLayersRise(const LayerAir& air, int level) {
  std::vector<float> one(air.columns);
  const float* bottom_m = air.interface_height_m.data() + level * air.columns;
  for (std::size_t i = 0; i < air.columns; ++i) {
    one[i] = bottom_m[i + air.columns] > bottom_m[i] ? 1.0F : 0.0F;
  }
  return one;
}

}  // namespace

volume::FieldStatistics AmountToConcentration(const LayerAir& air,
                                              const std::vector<float>& density_kg_per_m3,
                                              std::vector<float>& values) {
  volume::FieldStatistics statistics;
  ScanRange range;
  std::vector<double> water_path(air.columns, 0.0);
  const bool per_volume = density_kg_per_m3.empty();
  std::vector<float> one;
  for (int level = 0; level < air.levels; ++level) {
    const std::size_t offset = level * air.columns;
    if (per_volume) one = OneWhereLayersRise(air, level);
    ScanLevel(air, level, per_volume ? one.data() : density_kg_per_m3.data() + offset,
              values.data() + offset, statistics, range, water_path);
  }
  if (range.minimum <= range.maximum) {
    statistics.minimum = range.minimum;
    statistics.maximum = range.maximum;
  }
  const double total = std::accumulate(water_path.begin(), water_path.end(), 0.0);
  statistics.mean_water_path_kg_per_m2 = total / static_cast<double>(air.columns);
  statistics.maximum_water_path_kg_per_m2 = *std::ranges::max_element(water_path);
  return statistics;
}

double ShareWithoutAir(const LayerAir& air, const std::vector<float>& density_kg_per_m3,
                       const std::vector<float>& amounts) {
  double all = 0.0;
  double without = 0.0;
  for (std::size_t i = 0; i < amounts.size(); ++i) {
    const float amount = amounts[i];
    const double thickness_m = air.interface_height_m[i + air.columns] - air.interface_height_m[i];
    // The negated comparison is also true for NaN.
    if (!(thickness_m > 0.0) || !(amount > 0.0F && amount < kInfinity)) continue;
    all += amount * thickness_m;
    if (!(density_kg_per_m3[i] > 0.0F)) without += amount * thickness_m;
  }
  return all > 0.0 ? without / all : 0.0;
}

volume::CellBox FlushAndBound(const volume::RegularGrid& grid,
                              std::vector<float>& concentration_kg_per_m3) {
  volume::CellBox box{grid.cells, glm::ivec3(0)};
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      float* row = concentration_kg_per_m3.data() + grid.Offset(0, y, z);
      int first = grid.cells.x;
      int last = -1;
      for (int x = 0; x < grid.cells.x; ++x) {
        if (row[x] < kSmallestNormal) {
          row[x] = 0.0F;
          continue;
        }
        first = std::min(first, x);
        last = x;
      }
      if (last < 0) continue;
      box.low = glm::min(box.low, glm::ivec3(first, y, z));
      box.high = glm::max(box.high, glm::ivec3(last + 1, y + 1, z + 1));
    }
  }
  return box.Empty() ? volume::CellBox{} : box;
}

volume::CellBox Union(const volume::CellBox& a, const volume::CellBox& b) {
  if (a.Empty()) return b;
  if (b.Empty()) return a;
  return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}

}  // namespace thunderhead::storm_files
