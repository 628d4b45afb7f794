// Remaps terrain-following layers to a regular height grid, so that every column keeps its mass. A
// target cell gets the integral of the layers over it. Within a layer the profile is linear, with
// its slope limited so that no new extreme appears (van Leer 1977). This code is pure arithmetic
// and does not depend on files.
#pragma once

#include <cstddef>
#include <vector>

namespace thunderhead::storm_files {

// No cloud of a storm is higher than this. Models reach up to 80 km, and a grid up to there would
// have cells that are several times as thick as the layers of clouds.
inline constexpr double kHighestCloud_m = 30'000.0;

struct VerticalGrid {
  double low_m = 0.0;
  double spacing_m = 0.0;
  int cells = 0;

  double High_m() const { return low_m + spacing_m * cells; }
};

// The layers of a block of columns. In all arrays the column runs fastest, then levels upwards. A
// layer is missing if its heights are NaN or do not increase.
struct Layers {
  const float* interface_height_m;  // (levels + 1) * stride values
  const float* concentration;       // levels * stride values, none below zero and none NaN
  int levels;
  std::size_t stride;  // number of values from one level of a column to the next level
};

// Returns a grid that reaches from the lowest to the highest interface of `columns` columns, with a
// small margin above. It ends at `highest_m` if the interfaces reach above this height and begin
// below half of it. Its cells are as thin as the thinnest level (mean over columns), but there are
// at most 1.25 times as many cells as levels. VerticalGrid::cells is zero if all layers are
// missing.
VerticalGrid ChooseVerticalGrid(const std::vector<float>& interface_height_m, int levels,
                                std::size_t columns, double highest_m = kHighestCloud_m);

// Returns the grid of which the layers of every column are the cells. VerticalGrid::cells is zero
// if there is none, because layers differ in thickness or columns in height by more than 1 %.
VerticalGrid GridOfEvenLayers(const std::vector<float>& interface_height_m, int levels,
                              std::size_t columns);

// Returns whether the layers of every column are the cells of `grid`, to 1 % of a cell.
bool LayersAreCells(const std::vector<float>& interface_height_m, int levels, std::size_t columns,
                    const VerticalGrid& grid);

// Returns `grid` extended by whole cells below and above until it contains every interface, but not
// above `highest_m`, as in ChooseVerticalGrid.
VerticalGrid Extended(const VerticalGrid& grid, const std::vector<float>& interface_height_m,
                      double highest_m = kHighestCloud_m);

// Adds the concentration in column `column` of `layers` to `target`, which holds one mean for each
// of the `grid.cells` cells. These means are `target_stride` values apart and must be zero before
// the call. Mass outside the grid goes into its outermost cells.
void RemapColumn(const Layers& layers, std::size_t column, const VerticalGrid& grid, float* target,
                 std::size_t target_stride);

// Remaps `columns` columns. Returns `grid.cells` * `columns` values, column fastest, then upwards.
std::vector<float> RemapColumns(const std::vector<float>& interface_height_m,
                                const std::vector<float>& concentration, int levels,
                                std::size_t columns, const VerticalGrid& grid);

}  // namespace thunderhead::storm_files
