// What the columns of a medium with detail hold, from the medium at many points in each of their
// cells. Knows no scene and no GL.
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
  // Shares of the sum of all channels that interpolation takes from the 3 x 3 columns around, x
  // fastest.
  std::array<float, 9> shares{};
};

// Points at which a column is evaluated.
struct ColumnPoints {
  // In each cell; at least, where there is an error.
  int at_surface = 1;  // where billows may end
  int elsewhere = 1;

  // Where it is not 0, cells in which the medium varies get more, until the column's sum has this
  // relative standard error, or where its optical depth is less than 1, that depth has this error;
  // but at most so many of them in a column.
  double error = 0.0;
  int most = 0;
};

class DrawnColumns {
 public:
  // All must outlive it. When the control of a column changes, so do the columns beside it.
  DrawnColumns(const DetailControl& control, const PlacedDetail& detail,
               const ExtinctionVolume& volume);

  DrawnColumn Sum(const glm::ivec2& column, const ColumnPoints& points) const;

 private:
  // The levels at which there may be anything, `end` not included.
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
  std::vector<Levels> occupied_;  // by column
};

}  // namespace thunderhead::volume
