// The non-empty cells by number, column by column, upwards. Most of a storm's box is empty, so
// computed values are stored by number.
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
  // Returns blocks of whole columns for parallel work: their first numbers, and the count.
  const std::vector<std::size_t>& Blocks() const { return blocks_; }

  // A cell that has a value: a non-empty one, or an empty neighbour of one.
  struct Valued {
    std::int32_t cell;
    std::int32_t number;  // kNone if the cell is empty
  };
  // Returns the cells with values in ascending order.
  const std::vector<Valued>& WithValues() const { return valued_; }

  // Sets the non-empty cells to values by number. Other cells stay unchanged.
  void SetByCell(const std::vector<float>& by_number, std::vector<float>* by_cell) const;
  // Sets empty cells next to others to the mean of those.
  template <typename Value>
  void Spread(std::vector<Value>* by_cell) const {
    fringe_.Spread(by_cell);
  }

 private:
  std::vector<std::int32_t> number_;   // numbers by cell
  std::vector<std::int32_t> cell_of_;  // cells by number
  std::vector<std::size_t> blocks_;
  Fringe fringe_;
  std::vector<Valued> valued_;
};

}  // namespace thunderhead::renderers
