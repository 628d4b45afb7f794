#include "renderers/light_volume/fringe.h"

namespace thunderhead::renderers {

Fringe::Fringe(const DiffusionCells& cells, const std::vector<std::int32_t>& holding) {
  std::array<glm::ivec3, kAround> steps;
  for (std::size_t k = 0; k < kAround; ++k) {
    const auto at = static_cast<int>(k);
    steps[k] = {at % 3 - 1, at / 3 % 3 - 1, at / 9 - 1};
    around_[k] = (static_cast<std::ptrdiff_t>(steps[k].z) * cells.size.y + steps[k].y) *
                     static_cast<std::ptrdiff_t>(cells.size.x) +
                 steps[k].x;
  }
  // Each cell has a bit for each neighbour that has a value. Bit kHolds marks cells that have a
  // value themselves, which are not part of the fringe.
  constexpr std::uint32_t kHolds = 1U << (kAround / 2);
  std::vector<std::uint32_t> neighbours(cells.transport_per_m.size(), 0);
  for (const std::int32_t cell : holding) {
    const auto from = static_cast<std::size_t>(cell);
    const glm::ivec3 at = cells.CellAt(from);
    for (std::size_t k = 0; k < kAround; ++k) {
      const glm::ivec3 beside = at + steps[k];
      if (!cells.Contains(beside)) continue;
      neighbours[cells.Offset(beside)] |= 1U << (kAround - 1 - k);
    }
  }
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (neighbours[i] == 0 || (neighbours[i] & kHolds) != 0) continue;
    cells_.push_back({static_cast<std::int32_t>(i), neighbours[i]});
  }
}

}  // namespace thunderhead::renderers
