// Consecutive numbers for the non-empty cells, column by column, upwards. Most of a storm's box is
// empty, so computed values are stored by number instead of by cell index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderers/light_volume/diffusion_cells.h"
#include "renderers/light_volume/fringe.h"

namespace thunderhead::renderers {

class NumberedCells {
 public:
  static constexpr std::int32_t kNone = -1;

  explicit NumberedCells(const DiffusionCells& cells);

  std::size_t Count() const { return cell_of_.size(); }
  // Returns the number of all cells, including empty ones.
  std::size_t AllCells() const { return number_.size(); }
  // Returns kNone if the cell is empty.
  std::int32_t NumberOf(std::size_t cell) const { return number_[cell]; }
  bool IsEmpty(std::size_t cell) const { return number_[cell] == kNone; }
  std::size_t CellOf(std::size_t n) const { return static_cast<std::size_t>(cell_of_[n]); }
  // Returns blocks of whole columns for parallel work: the first number of each block, followed by
  // Count().
  const std::vector<std::size_t>& Blocks() const { return blocks_; }

  // A cell that has a value: a non-empty cell, or an empty cell next to a non-empty cell.
  struct Valued {
    std::int32_t cell;
    std::int32_t number;  // kNone if the cell is empty
  };
  // Returns the cells with values in ascending order.
  const std::vector<Valued>& WithValues() const { return valued_; }

  // Sets the non-empty cells of `by_cell` to their values from `by_number`. Other cells stay
  // unchanged.
  void SetByCell(const std::vector<float>& by_number, std::vector<float>* by_cell) const;
  // Sets each empty cell next to non-empty cells to the mean of their values.
  template <typename Value>
  void Spread(std::vector<Value>* by_cell) const {
    fringe_.Spread(by_cell);
  }

 private:
  std::vector<std::int32_t> number_;   // number of each cell
  std::vector<std::int32_t> cell_of_;  // cell index of each number
  std::vector<std::size_t> blocks_;
  Fringe fringe_;
  std::vector<Valued> valued_;
};

}  // namespace thunderhead::renderers
