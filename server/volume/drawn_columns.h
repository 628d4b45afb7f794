// Estimates how much medium each column holds when detail is drawn, by evaluating the medium at
// many points in each cell. This code does not depend on scenes or GL.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "glm/vec2.hpp"
#include "volume/detail_control.h"
#include "volume/drawn_medium.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

struct DrawnColumn {
  DrawnMedium::Channels sums{};  // sum over the column's levels of each channel's mean in the cell
  // The sum of all channels, split by the weights of bilinear interpolation among the 3 x 3 columns
  // around this one, x fastest.
  std::array<float, 9> shares{};
};

// The numbers of points at which a column is evaluated.
struct ColumnPoints {
  // The number of points in each cell. If an error target is set, these numbers are minimums.
  int at_surface = 1;  // in cells where the surface of billows may lie
  int elsewhere = 1;

  // The target for the relative standard error of the column's sum, or 0 for no target. Cells in
  // which the medium varies get more points to reach it. For a column whose optical depth is below
  // 1, the target is an absolute error of the optical depth. To reach the target, a column gets at
  // most `most` points.
  double error = 0.0;
  int most = 0;
};

class DrawnColumns {
 public:
  // All arguments must outlive this object. A change of the control data of one column also changes
  // the sums of its neighbours.
  DrawnColumns(const DetailControl& control, const PlacedDetail& detail,
               const ExtinctionVolume& volume);

  DrawnColumn Sum(const glm::ivec2& column, const ColumnPoints& points) const;

 private:
  // The range of levels that may hold medium, from `begin` to `end` - 1.
  struct Levels {
    int begin = 0;
    int end = 0;
  };

  Levels LevelsOf(const glm::ivec2& column) const;
  std::vector<double> PointsByError(const glm::ivec2& column, const Levels& levels,
                                    const ColumnPoints& points) const;
  bool HasSurface(const glm::ivec3& cell) const;

  const DrawnMedium medium_;
  const DetailControl& control_;
  const RegularGrid& grid_;
  const std::size_t channels_;
  const double cell_depth_;       // optical depth along a cell's height for the texel value 1
  std::vector<Levels> occupied_;  // one for each column
};

}  // namespace thunderhead::volume
