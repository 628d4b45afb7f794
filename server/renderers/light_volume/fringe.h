// The cells without a value that are next to cells with a value. They are set to the mean of those
// neighbours, so that interpolated values do not decrease towards the edge.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderers/light_volume/diffusion_cells.h"
#include "renderers/light_volume/shares.h"

namespace thunderhead::renderers {

class Fringe {
 public:
  Fringe() = default;
  // `holding` are the indices of the cells that have a value, in ascending order.
  Fringe(const DiffusionCells& cells, const std::vector<std::int32_t>& holding);

  std::size_t Count() const { return cells_.size(); }
  // Returns the index of the fringe's cell number `f`. The indices are in ascending order.
  std::int32_t CellOf(std::size_t f) const { return cells_[f].cell; }

  // Sets each cell of the fringe to the mean of those of its 26 neighbours that have a value.
  template <typename Value>
  void Spread(std::vector<Value>* values) const;

 private:
  static constexpr std::size_t kAround = 27;  // a cell and its 26 neighbours
  struct Cell {
    std::int32_t cell;
    std::uint32_t neighbours;  // bit k is set if the cell at cell + around_[k] has a value
  };

  std::array<std::ptrdiff_t, kAround> around_{};
  std::vector<Cell> cells_;
};

template <typename Value>
void Fringe::Spread(std::vector<Value>* values) const {
  ForShares(cells_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      Value* here = values->data() + cells_[f].cell;
      Value sum(0.0F);
      for (std::uint32_t left = cells_[f].neighbours; left != 0; left &= left - 1) {
        sum += here[around_[static_cast<std::size_t>(std::countr_zero(left))]];
      }
      *here = sum / static_cast<float>(std::popcount(cells_[f].neighbours));
    }
  });
}

}  // namespace thunderhead::renderers
