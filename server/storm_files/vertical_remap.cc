#include "storm_files/vertical_remap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::storm_files {
namespace {

// The number of columns that are processed together. Their floats fill one cache line, so that each
// cache line is fetched once.
constexpr std::size_t kTile = 16;

struct HeightRange {
  double low_m = std::numeric_limits<double>::infinity();
  double high_m = -std::numeric_limits<double>::infinity();
};

// Returns the heights that a grid must contain.
HeightRange RangeOf(const std::vector<float>& interface_height_m, double highest_m) {
  // NaN fails both comparisons, so it leaves the range as it is.
  float low_m = std::numeric_limits<float>::infinity();
  float high_m = -std::numeric_limits<float>::infinity();
  for (const float height_m : interface_height_m) {
    low_m = height_m < low_m ? height_m : low_m;
    high_m = height_m > high_m ? height_m : high_m;
  }
  const bool ends_above = high_m > highest_m && low_m < 0.5 * highest_m;
  return {low_m, ends_above ? highest_m : high_m};
}

// Returns the mean thickness over columns of the level for which this mean is smallest.
double ThinnestLevel_m(const std::vector<float>& interface_height_m, int levels,
                       std::size_t columns) {
  double thinnest_m = std::numeric_limits<double>::infinity();
  for (int level = 0; level < levels; ++level) {
    const float* bottom_m = interface_height_m.data() + level * columns;
    const float* top_m = bottom_m + columns;
    double sum_m = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < columns; ++i) {
      const float thickness_m = top_m[i] - bottom_m[i];
      if (!(thickness_m > 0.0F)) continue;
      sum_m += thickness_m;
      ++count;
    }
    if (count > 0) thinnest_m = std::min(thinnest_m, sum_m / static_cast<double>(count));
  }
  return thinnest_m;
}

struct Layer {
  double bottom_m;
  double top_m;
  double mean;

  double Thickness_m() const { return top_m - bottom_m; }
  double Middle_m() const { return 0.5 * (bottom_m + top_m); }
};

Layer LayerAt(const Layers& layers, std::size_t column, int level) {
  const std::size_t at = level * layers.stride + column;
  return {layers.interface_height_m[at], layers.interface_height_m[at + layers.stride],
          layers.concentration[at]};
}

bool IsThere(const Layer& layer) { return layer.top_m > layer.bottom_m; }

// Returns the monotonised central slope. With it, the profile at the layer's ends stays between the
// means of the layer and of its neighbours.
double LimitedSlope_per_m(const Layers& layers, std::size_t column, int level, const Layer& layer) {
  if (level == 0 || level + 1 == layers.levels) return 0.0;
  const Layer below = LayerAt(layers, column, level - 1);
  const Layer above = LayerAt(layers, column, level + 1);
  if (!IsThere(below) || !IsThere(above)) return 0.0;
  const double rise_below = layer.mean - below.mean;
  const double rise_above = above.mean - layer.mean;
  if (rise_below * rise_above <= 0.0) return 0.0;
  const double central = (above.mean - below.mean) / (above.Middle_m() - below.Middle_m());
  const double limit =
      2.0 * std::min(std::abs(rise_below), std::abs(rise_above)) / layer.Thickness_m();
  return std::copysign(std::min(std::abs(central), limit), central);
}

// A tile of columns that is copied at once, so that the large arrays are traversed once.
class Tile {
 public:
  Tile(int levels, const VerticalGrid& grid)
      : levels_(levels),
        grid_(grid),
        height_m_((levels + 1) * kTile),
        concentration_(levels * kTile),
        target_(grid.cells * kTile) {}

  // Returns false if the tile is empty.
  bool Load(const std::vector<float>& concentration, std::size_t columns, std::size_t first,
            std::size_t count) {
    float largest = 0.0F;
    for (int level = 0; level < levels_; ++level) {
      const float* from = concentration.data() + level * columns + first;
      float* to = concentration_.data() + level * kTile;
      for (std::size_t i = 0; i < count; ++i) {
        to[i] = from[i];
        largest = std::max(largest, from[i]);
      }
    }
    return largest > 0.0F;
  }

  void Remap(const std::vector<float>& interface_height_m, std::size_t columns, std::size_t first,
             std::size_t count, std::vector<float>& result) {
    for (int level = 0; level <= levels_; ++level) {
      const float* from = interface_height_m.data() + level * columns + first;
      std::copy_n(from, count, height_m_.data() + level * kTile);
    }
    std::ranges::fill(target_, 0.0F);
    const Layers layers{height_m_.data(), concentration_.data(), levels_, kTile};
    for (std::size_t i = 0; i < count; ++i) RemapColumn(layers, i, grid_, &target_[i], kTile);
    for (int cell = 0; cell < grid_.cells; ++cell) {
      std::copy_n(target_.data() + cell * kTile, count, result.data() + cell * columns + first);
    }
  }

 private:
  int levels_;
  VerticalGrid grid_;
  std::vector<float> height_m_;
  std::vector<float> concentration_;
  std::vector<float> target_;
};

}  // namespace

VerticalGrid ChooseVerticalGrid(const std::vector<float>& interface_height_m, int levels,
                                std::size_t columns, double highest_m) {
  const HeightRange range = RangeOf(interface_height_m, highest_m);
  const double thinnest_m = ThinnestLevel_m(interface_height_m, levels, columns);
  if (!(range.high_m > range.low_m) || !std::isfinite(thinnest_m)) return {};
  // With at most a quarter more cells than levels, memory stays below 1.5 times the file's
  // uncompressed size.
  const int max_cells = std::max(1, levels * 5 / 4);
  // The layers' heights vary a little between the times of a storm. Because of this margin, one
  // grid fits all times.
  constexpr double kRoomAbove = 0.005;
  const double extent_m =
      (range.high_m - range.low_m) * (max_cells > levels ? 1.0 + kRoomAbove : 1.0);
  const double spacing_m = std::max(thinnest_m, extent_m / max_cells);
  constexpr double kRounding = 1e-6;
  const int cells = static_cast<int>(std::ceil(extent_m / spacing_m - kRounding));
  return {range.low_m, spacing_m, std::clamp(cells, 1, max_cells)};
}

bool LayersAreCells(const std::vector<float>& interface_height_m, int levels, std::size_t columns,
                    const VerticalGrid& grid) {
  if (levels != grid.cells || !(grid.spacing_m > 0.0)) return false;
  // Coordinates are often rounded when they are written, or stored in single precision.
  constexpr double kTolerance = 1e-2;
  for (int level = 0; level <= levels; ++level) {
    const double face_m = grid.low_m + level * grid.spacing_m;
    const float* height_m = interface_height_m.data() + level * columns;
    const bool even = std::all_of(height_m, height_m + columns, [&](float each_m) {
      return std::abs(each_m - face_m) <= kTolerance * grid.spacing_m;
    });
    if (!even) return false;
  }
  return true;
}

VerticalGrid GridOfEvenLayers(const std::vector<float>& interface_height_m, int levels,
                              std::size_t columns) {
  const HeightRange range = RangeOf(interface_height_m, std::numeric_limits<double>::infinity());
  const VerticalGrid grid{range.low_m, (range.high_m - range.low_m) / levels, levels};
  const bool even = LayersAreCells(interface_height_m, levels, columns, grid);
  return even ? grid : VerticalGrid{};
}

VerticalGrid Extended(const VerticalGrid& grid, const std::vector<float>& interface_height_m,
                      double highest_m) {
  const HeightRange range = RangeOf(interface_height_m, highest_m);
  // Heights are in single precision, so differences of centimetres are rounding.
  constexpr double kSame_m = 0.05;
  // More layers than this fit in no memory. The limit keeps the number within an int.
  constexpr double kMostLayers = 1e8;
  const auto cells_of = [&](double extent_m) {
    return static_cast<int>(std::min(std::ceil(extent_m / grid.spacing_m), kMostLayers));
  };
  VerticalGrid extended = grid;
  if (range.low_m < grid.low_m - kSame_m) {
    const int below = cells_of(grid.low_m - range.low_m);
    extended.low_m -= below * grid.spacing_m;
    extended.cells += below;
  }
  if (range.high_m > grid.High_m() + kSame_m) {
    extended.cells += cells_of(range.high_m - grid.High_m());
  }
  return extended;
}

void RemapColumn(const Layers& layers, std::size_t column, const VerticalGrid& grid, float* target,
                 std::size_t target_stride) {
  const double per_spacing = 1.0 / grid.spacing_m;
  for (int level = 0; level < layers.levels; ++level) {
    const Layer layer = LayerAt(layers, column, level);
    if (!(layer.mean > 0.0) || !IsThere(layer)) continue;
    const double slope_per_m = LimitedSlope_per_m(layers, column, level, layer);
    const double start = std::floor((layer.bottom_m - grid.low_m) * per_spacing);
    int cell = static_cast<int>(std::clamp(start, 0.0, grid.cells - 1.0));
    double from_m = layer.bottom_m;
    while (from_m < layer.top_m) {
      // The grid's last cell takes the rest of the layer, so that no mass above the grid is lost.
      const double cell_top_m = grid.low_m + (cell + 1) * grid.spacing_m;
      const bool last = cell + 1 == grid.cells || cell_top_m >= layer.top_m;
      const double to_m = last ? layer.top_m : std::max(cell_top_m, from_m);
      const double mean = layer.mean + slope_per_m * (0.5 * (from_m + to_m) - layer.Middle_m());
      target[cell * target_stride] +=
          static_cast<float>(std::max(mean, 0.0) * (to_m - from_m) * per_spacing);
      from_m = to_m;
      ++cell;
      if (last) break;
    }
  }
}

std::vector<float> RemapColumns(const std::vector<float>& interface_height_m,
                                const std::vector<float>& concentration, int levels,
                                std::size_t columns, const VerticalGrid& grid) {
  THUNDERHEAD_CHECK(interface_height_m.size() == (levels + 1) * columns,
                    absl::StrCat(interface_height_m.size()));
  THUNDERHEAD_CHECK(concentration.size() == levels * columns, absl::StrCat(concentration.size()));
  std::vector<float> result(grid.cells * columns);
  Tile tile(levels, grid);
  for (std::size_t first = 0; first < columns; first += kTile) {
    const std::size_t count = std::min(kTile, columns - first);
    if (tile.Load(concentration, columns, first, count)) {
      tile.Remap(interface_height_m, columns, first, count, result);
    }
  }
  return result;
}

}  // namespace thunderhead::storm_files
