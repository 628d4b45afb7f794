#include "volume/strongest_core.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "glm/common.hpp"
#include "glm/ext/vector_int2.hpp"
#include "volume/terrain.h"

namespace thunderhead::volume {
namespace {

constexpr double kWidestSmoothing_m = 3000.0;
constexpr double kSmoothingPerHeight = 0.25;

// Share of a column's optical depth that lies above its top.
constexpr double kShareAboveTop = 1e-3;

// Optical depth of every column of the domain, and extinction summed over every level. Only cells
// in a box are counted.
struct Sums {
  std::vector<double> columns;
  std::vector<double> levels;
};

void AddField(const HydrometeorField& field, const RegularGrid& grid, const CellBox& box,
              physics::SizeSource sizes, Sums* sums) {
  const MassExtinction mass_extinction =
      MassExtinctionOf(field, physics::DefaultOptics(field.hydrometeor), sizes);
  std::vector<float> row(static_cast<std::size_t>(box.high.x - box.low.x));
  for (int z = box.low.z; z < box.high.z; ++z) {
    for (int y = box.low.y; y < box.high.y; ++y) {
      row.assign(row.size(), 0.0F);
      AddExtinction(field, mass_extinction, grid.Offset(box.low.x, y, z), row.size(), row.data());
      double* const columns = sums->columns.data() + grid.Offset(box.low.x, y, 0);
      for (std::size_t i = 0; i < row.size(); ++i) columns[i] += row[i] * grid.spacing_m.z;
      sums->levels[static_cast<std::size_t>(z)] += std::accumulate(row.begin(), row.end(), 0.0);
    }
  }
}

Sums SumsOf(const HydrometeorFields& fields, const CellBox& box, physics::SizeSource sizes) {
  Sums sums;
  sums.columns.assign(fields.grid.Offset(0, 0, 1), 0.0);
  sums.levels.assign(static_cast<std::size_t>(fields.grid.cells.z), 0.0);
  if (box.Empty()) return sums;
  for (const HydrometeorField& field : fields.fields) {
    if (!field.concentration_kg_per_m3.empty()) AddField(field, fields.grid, box, sizes, &sums);
  }
  return sums;
}

// Returns the height above sea level that has kShareAboveTop of the levels' sum above it.
double TopOf(const std::vector<double>& levels, const RegularGrid& grid) {
  const double max_above = kShareAboveTop * std::accumulate(levels.begin(), levels.end(), 0.0);
  std::size_t level = levels.size() - 1;
  for (double above = levels[level]; above <= max_above && level > 0;) above += levels[--level];
  return grid.low_corner_m.z + static_cast<double>(level + 1) * grid.spacing_m.z;
}

// Replaces each of `count` values, `stride` apart, by the mean of the values at most `radius` away.
void SmoothLine(double* values, int count, std::ptrdiff_t stride, int radius) {
  std::vector<double> sum_before{0.0};
  for (int i = 0; i < count; ++i) sum_before.push_back(sum_before.back() + values[i * stride]);
  for (int i = 0; i < count; ++i) {
    const int low = std::max(i - radius, 0);
    const int high = std::min(i + radius + 1, count);
    values[i * stride] =
        (sum_before[static_cast<std::size_t>(high)] - sum_before[static_cast<std::size_t>(low)]) /
        (high - low);
  }
}

void Smooth(std::vector<double>& columns, const glm::ivec3& cells, const glm::ivec2& radius) {
  // Smooths twice, because after one box mean the values next to a lone peak equal the peak.
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < cells.y; ++y) {
      SmoothLine(columns.data() + static_cast<std::ptrdiff_t>(y) * cells.x, cells.x, 1, radius.x);
    }
    for (int x = 0; x < cells.x; ++x) SmoothLine(columns.data() + x, cells.y, cells.x, radius.y);
  }
}

// Returns the cells of `box` in columns at most `radius` from `column`.
CellBox Around(const glm::ivec2& column, const glm::ivec2& radius, CellBox box) {
  for (int axis = 0; axis < 2; ++axis) {
    box.low[axis] = std::max(box.low[axis], column[axis] - radius[axis]);
    box.high[axis] = std::min(box.high[axis], column[axis] + radius[axis] + 1);
  }
  return box;
}

}  // namespace

std::optional<StormCore> StrongestCore(const HydrometeorFields& fields, physics::SizeSource sizes) {
  const RegularGrid& grid = fields.grid;
  Sums storm = SumsOf(fields, fields.condensate, sizes);
  if (*std::max_element(storm.columns.begin(), storm.columns.end()) <= 0.0) return std::nullopt;
  const double height_m = TopOf(storm.levels, grid) - LowestTerrain_m(fields);
  const double smoothing_m = std::min(kSmoothingPerHeight * height_m, kWidestSmoothing_m);
  // Two means over boxes of half the width make one over a triangle of the full width.
  const glm::ivec2 radius(glm::round(0.25 * smoothing_m / glm::dvec2(grid.spacing_m)));
  Smooth(storm.columns, grid.cells, radius);
  const auto strongest = static_cast<int>(
      std::max_element(storm.columns.begin(), storm.columns.end()) - storm.columns.begin());
  const glm::ivec2 column(strongest % grid.cells.x, strongest / grid.cells.x);

  StormCore core;
  core.place_m =
      glm::dvec2(grid.low_corner_m) + (glm::dvec2(column) + 0.5) * glm::dvec2(grid.spacing_m);
  core.ground_m = TerrainHeight_m(fields, core.place_m);
  // A tower in shear leans, so its top may be in another column.
  const glm::ivec2 reach(glm::round(0.5 * height_m / glm::dvec2(grid.spacing_m)));
  const double top_m =
      TopOf(SumsOf(fields, Around(column, reach, fields.condensate), sizes).levels, grid);
  core.top_m = std::max(top_m, core.ground_m + grid.spacing_m.z);
  return core;
}

}  // namespace thunderhead::volume
