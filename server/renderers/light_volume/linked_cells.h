// Cells that exchange diffuse light with the six beside them: a symmetric linear system, and
// preconditioned conjugate gradients to solve it. Knows nothing of light but its conductances.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderers/light_volume/numbered_cells.h"

namespace thunderhead::renderers {

// A cell's links down each axis, or up each. Apart, as the solver reads one kind after the other,
// and waits for memory most of its time.
struct Links {
  std::int32_t to[3];  // numbers; NumberedCells::kNone: out of the medium
  float conductance[3];
};

class LinkedCells {
 public:
  LinkedCells() = default;
  // By number: the links, both ends of one with the same conductance, and the loss of each cell
  // besides, as a conductance. `blocks` is NumberedCells::Blocks().
  LinkedCells(std::vector<Links> down, std::vector<Links> up, const std::vector<float>& loss,
              std::vector<std::size_t> blocks);

  // Of one of a cell's six sides: even numbers down, odd ones up an axis.
  const Links& LinksOf(std::size_t n, int side) const { return side % 2 == 1 ? up_[n] : down_[n]; }

  const Links& Up(std::size_t n) const { return up_[n]; }

  // Solves for what each cell has if `right` is put into it, from `solution` on, until the
  // residual, in the preconditioner's norm, is less than `tolerance` times the right side. Returns
  // the number of iterations, 200 at most.
  int Solve(const std::vector<float>& right, double tolerance, std::vector<float>* solution);

 private:
  void Factor();
  // Both return the product of `from` and `to`.
  double Precondition(const std::vector<float>& from, std::vector<float>* to) const;
  double Apply(const std::vector<float>& from, std::vector<float>* to) const;

  std::vector<Links> down_, up_;
  std::vector<std::size_t> blocks_;  // preconditioned each by itself, at the same time
  std::vector<float> diagonal_;
  std::vector<float> inverse_pivot_;  // of the incomplete Cholesky factor
  std::vector<float> residual_, direction_, image_, better_;
};

}  // namespace thunderhead::renderers
