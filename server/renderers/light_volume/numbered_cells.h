// The cells that hold anything, by number: column by column, upwards. Most of a storm's box is
// empty, and what is worked out for each cell is kept by number.
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
  // Of all cells, empty ones too.
  std::size_t AllCells() const { return number_.size(); }
  // kNone if the cell is empty.
  std::int32_t NumberOf(std::size_t cell) const { return number_[cell]; }
  bool IsEmpty(std::size_t cell) const { return number_[cell] == kNone; }
  std::size_t CellOf(std::size_t n) const { return static_cast<std::size_t>(cell_of_[n]); }
  // Blocks of whole columns, to be worked on at the same time: their first numbers, and the count.
  const std::vector<std::size_t>& Blocks() const { return blocks_; }

  // A cell that has a value: one that holds anything, or an empty one beside such.
  struct Valued {
    std::int32_t cell;
    std::int32_t number;  // kNone if it is empty
  };
  // In rising order.
  const std::vector<Valued>& WithValues() const { return valued_; }

  // Sets the cells that hold anything to values by number; others stay as they are.
  void SetByCell(const std::vector<float>& by_number, std::vector<float>* by_cell) const;
  // Sets empty cells beside others to the mean of those.
  template <typename Value>
  void Spread(std::vector<Value>* by_cell) const {
    fringe_.Spread(by_cell);
  }

 private:
  std::vector<std::int32_t> number_;   // by cell
  std::vector<std::int32_t> cell_of_;  // by number
  std::vector<std::size_t> blocks_;
  Fringe fringe_;
  std::vector<Valued> valued_;
};

}  // namespace thunderhead::renderers
