// Computes what the columns of a medium with detail hold, from the medium at many points in each of
// their cells. This code does not depend on scenes or GL.
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
  DrawnMedium::Channels sums{};  // over the column's levels
  // The shares of the sum of all channels that interpolation takes from the 3 x 3 columns around
  // this one, x fastest.
  std::array<float, 9> shares{};
};

// The number of points at which a column is evaluated.
struct ColumnPoints {
  // Points in each cell. With an error target these are minimums.
  int at_surface = 1;  // in cells where billows may end
  int elsewhere = 1;

  // The error target, or 0 for none. With a target, cells in which the medium varies get more
  // points until the column's sum has this relative standard error. For an optical depth below 1,
  // the target is this absolute error of the depth. A column gets at most `most` points.
  double error = 0.0;
  int most = 0;
};

class DrawnColumns {
 public:
  // All arguments must outlive this object. When a column's control changes, the columns next to it
  // change, too.
  DrawnColumns(const DetailControl& control, const PlacedDetail& detail,
               const ExtinctionVolume& volume);

  DrawnColumn Sum(const glm::ivec2& column, const ColumnPoints& points) const;

 private:
  // The range of levels that may hold anything, without `end`.
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
  const double cell_depth_;       // optical depth of a cell's height where a texel is 1
  std::vector<Levels> occupied_;  // one for each column
};

}  // namespace thunderhead::volume
