// The regular grid on which storms are drawn. World coordinates are in metres: x is east and y
// north of the middle of the domain, and z is up from sea level. Cells are boxes. Values are cell
// means and are placed at cell centres.
#pragma once

#include <cstddef>

#include "glm/vec3.hpp"

namespace thunderhead::volume {

struct RegularGrid {
  glm::ivec3 cells{0};           // nx, ny, nz
  glm::dvec3 spacing_m{0.0};     // dx, dy, dz
  glm::dvec3 low_corner_m{0.0};  // low corner of cell (0, 0, 0)

  glm::dvec3 HighCorner_m() const { return low_corner_m + glm::dvec3(cells) * spacing_m; }
  std::size_t CellCount() const {
    return static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y) *
           static_cast<std::size_t>(cells.z);
  }
  // Returns the index of cell (x, y, z) in an array in which x runs fastest, then y, then z.
  std::size_t Offset(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(cells.y) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(cells.x) +
           static_cast<std::size_t>(x);
  }

  bool operator==(const RegularGrid&) const = default;
};

// A box of cells. It includes `low` but not `high`.
struct CellBox {
  glm::ivec3 low{0};
  glm::ivec3 high{0};

  bool Empty() const { return high.x <= low.x || high.y <= low.y || high.z <= low.z; }
  bool operator==(const CellBox&) const = default;
};

}  // namespace thunderhead::volume
