#include "renderers/light_volume/numbered_cells.h"

#include <algorithm>

#include "renderers/light_volume/shares.h"

namespace thunderhead::renderers {
namespace {

// Cells with a smaller optical depth count as empty.
constexpr float kEmptyDepth = 1e-4F;

constexpr std::size_t kMaxBlocks = 16;

}  // namespace

NumberedCells::NumberedCells(const DiffusionCells& cells) {
  const auto smallest =
      static_cast<float>(std::min({cells.cell_m.x, cells.cell_m.y, cells.cell_m.z}));
  number_.assign(cells.light_per_m.size(), kNone);
  const glm::ivec3& size = cells.size;
  std::vector<std::int32_t> column_of;  // column of each numbered cell
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      for (int z = 0; z < size.z; ++z) {
        const std::size_t i = cells.Offset({x, y, z});
        if (cells.light_per_m[i] * smallest <= kEmptyDepth) continue;
        number_[i] = static_cast<std::int32_t>(cell_of_.size());
        cell_of_.push_back(static_cast<std::int32_t>(i));
        column_of.push_back(y * size.x + x);
      }
    }
  }
  const std::size_t count = cell_of_.size();
  const std::size_t usual = std::max((count + kMaxBlocks - 1) / kMaxBlocks, kShare);
  blocks_ = {0};
  for (std::size_t n = 1; n < count; ++n) {
    const bool begins_column = column_of[n] != column_of[n - 1];
    if (begins_column && n >= blocks_.back() + usual) blocks_.push_back(n);
  }
  blocks_.push_back(count);
  fringe_ = Fringe(cells, cell_of_);
  valued_.reserve(count + fringe_.Count());
  std::size_t next = 0;
  for (std::size_t i = 0; i < number_.size(); ++i) {
    const bool in_fringe =
        next < fringe_.Count() && fringe_.CellOf(next) == static_cast<std::int32_t>(i);
    if (in_fringe) ++next;
    if (in_fringe || number_[i] != kNone) {
      valued_.push_back({static_cast<std::int32_t>(i), number_[i]});
    }
  }
}

// The loop follows the order of cells, because the cells are contiguous in memory. The values by
// number are few and cost little to look up.
void NumberedCells::SetByCell(const std::vector<float>& by_number,
                              std::vector<float>* by_cell) const {
  ForShares(valued_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto [cell, n] = valued_[v];
      if (n == kNone) continue;
      (*by_cell)[static_cast<std::size_t>(cell)] = by_number[static_cast<std::size_t>(n)];
    }
  });
}

}  // namespace thunderhead::renderers
