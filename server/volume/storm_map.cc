#include "volume/storm_map.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "glm/common.hpp"
#include "volume/field_values.h"

namespace thunderhead::volume {
namespace {

// Computes a field's water path in each column and finds where the field is strongest.
class ColumnScan {
 public:
  ColumnScan(const HydrometeorFields& fields, std::size_t index)
      : fields_(fields),
        field_(fields.fields[index]),
        columns_(fields.grid.Offset(0, 0, 1), 0.0),
        ratio_(QuantityOf(fields, field_) == Quantity::kMixingRatio) {
    peak_.index = index;
    if (field_.concentration_kg_per_m3.empty()) return;
    const CellBox& box = fields.condensate;
    for (int z = box.low.z; z < box.high.z; ++z) {
      const float thinnest = ratio_ ? ThinnestAir_kg_per_m3(z) : 1.0F;
      for (int y = box.low.y; y < box.high.y; ++y) AddRow(y, z, thinnest);
    }
    FinishPeak();
  }

  const std::vector<double>& Columns() const { return columns_; }
  const FieldPeak& Peak() const { return peak_; }

 private:
  float ThinnestAir_kg_per_m3(int z) const {
    const std::vector<float>& air = fields_.air.kg_per_m3;
    const auto blocks = static_cast<std::ptrdiff_t>(fields_.air.blocks.x) * fields_.air.blocks.y;
    return *std::min_element(air.begin() + z * blocks, air.begin() + (z + 1) * blocks);
  }

  void AddRow(int y, int z, float thinnest) {
    const CellBox& box = fields_.condensate;
    const float* const row = field_.concentration_kg_per_m3.data() + fields_.grid.Offset(0, y, z);
    double* const columns = columns_.data() + fields_.grid.Offset(0, y, 0);
    // Looking up the air's density is the slowest part. It is needed only for cells that can exceed
    // the largest value so far.
    const float least = peak_.value * thinnest;
    for (int x = box.low.x; x < box.high.x; ++x) {
      columns[x] += row[x];
      if (row[x] <= least) continue;
      const float value = ValueAt(fields_, field_, {x, y, z});
      if (value <= peak_.value) continue;
      peak_.value = value;
      cell_ = {x, y, z};
    }
  }

  void FinishPeak() {
    const RegularGrid& grid = fields_.grid;
    for (double& column : columns_) column *= grid.spacing_m.z;
    if (peak_.value <= 0.0F) return;
    peak_.kg_per_m3 =
        MassOf(field_, field_.concentration_kg_per_m3[grid.Offset(cell_.x, cell_.y, cell_.z)]);
    peak_.position_m = grid.low_corner_m + (glm::dvec3(cell_) + 0.5) * grid.spacing_m;
    const auto largest = std::ranges::max_element(columns_);
    const auto at = static_cast<int>(largest - columns_.begin());
    peak_.column_kg_per_m2 = *largest;
    peak_.column_position_m =
        glm::dvec2(grid.low_corner_m) +
        (glm::dvec2(at % grid.cells.x, at / grid.cells.x) + 0.5) * glm::dvec2(grid.spacing_m);
  }

  const HydrometeorFields& fields_;
  const HydrometeorField& field_;
  std::vector<double> columns_;
  const bool ratio_;
  glm::ivec3 cell_{0};
  FieldPeak peak_;
};

// Returns one pixel for each column, or fewer if the limit is lower.
glm::ivec2 SizeFor(const glm::ivec2& columns, int max_size_px) {
  const int longer = std::max(columns.x, columns.y);
  if (longer <= max_size_px) return columns;
  return glm::max(glm::ivec2(glm::round(glm::dvec2(columns) * (1.0 * max_size_px / longer))), 1);
}

// Computes means along one axis. `lines` lines of `from` values become lines of `to` values.
std::vector<double> ResampledLines(const std::vector<double>& values, int lines, int from, int to,
                                   bool along_x) {
  std::vector<double> result(static_cast<std::size_t>(lines) * static_cast<std::size_t>(to));
  const auto at = [&](int line, int i, int length) {
    return along_x ? static_cast<std::size_t>(line) * static_cast<std::size_t>(length) +
                         static_cast<std::size_t>(i)
                   : static_cast<std::size_t>(i) * static_cast<std::size_t>(lines) +
                         static_cast<std::size_t>(line);
  };
  const double width = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double low = i * width;
    const double high = std::min((i + 1) * width, static_cast<double>(from));
    for (int j = static_cast<int>(low); j < std::min(static_cast<int>(std::ceil(high)), from);
         ++j) {
      const double share =
          (std::min(high, j + 1.0) - std::max(low, static_cast<double>(j))) / width;
      for (int line = 0; line < lines; ++line) {
        result[at(line, i, to)] += share * values[at(line, j, from)];
      }
    }
  }
  return result;
}

std::vector<float> ToFloats(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

}  // namespace

std::vector<double> Resampled(const std::vector<double>& values, const glm::ivec2& from,
                              const glm::ivec2& to) {
  return ResampledLines(ResampledLines(values, from.y, from.x, to.x, true), to.x, from.y, to.y,
                        false);
}

StormMap MapOf(const HydrometeorFields& fields, const StormMapSettings& settings) {
  StormMap map;
  const glm::ivec2 columns(fields.grid.cells);
  map.size_px = SizeFor(columns, settings.max_size_px);
  std::vector<double> sums(fields.grid.Offset(0, 0, 1), 0.0);
  for (std::size_t index = 0; index < fields.fields.size(); ++index) {
    const ColumnScan scan(fields, index);
    map.peaks.push_back(scan.Peak());
    if (std::ranges::find(settings.fields, index) == settings.fields.end()) continue;
    std::ranges::transform(sums, scan.Columns(), sums.begin(), std::plus<>());
  }
  map.values = ToFloats(Resampled(sums, columns, map.size_px));
  if (settings.with_terrain) {
    std::vector<double> heights_m(sums.size(), fields.grid.low_corner_m.z);
    if (!fields.terrain_height_m.empty()) {
      heights_m.assign(fields.terrain_height_m.begin(), fields.terrain_height_m.end());
    }
    map.terrain_height_m = ToFloats(Resampled(heights_m, columns, map.size_px));
  }
  return map;
}

}  // namespace thunderhead::volume
