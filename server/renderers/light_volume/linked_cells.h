// Cells that exchange diffuse light with their six neighbours. They form a symmetric linear system,
// which preconditioned conjugate gradients solve. This code uses only conductances of light.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderers/light_volume/numbered_cells.h"

namespace thunderhead::renderers {

// A cell's links down each axis, or up each axis. They are separate, because the solver reads one
// kind after the other and is limited by memory access.
struct Links {
  std::int32_t to[3];  // numbers; NumberedCells::kNone: outside the medium
  float conductance[3];
};

class LinkedCells {
 public:
  LinkedCells() = default;
  // Creates the system from links by number. Both ends of a link have the same conductance. `loss`
  // is the further loss of each cell, as a conductance. `blocks` is NumberedCells::Blocks().
  LinkedCells(std::vector<Links> down, std::vector<Links> up, const std::vector<float>& loss,
              std::vector<std::size_t> blocks);

  // Returns the links of one of a cell's six sides. Even numbers are down, odd ones up an axis.
  const Links& LinksOf(std::size_t n, int side) const { return side % 2 == 1 ? up_[n] : down_[n]; }

  const Links& Up(std::size_t n) const { return up_[n]; }

  // Solves for the value of each cell if `right` is put into it, beginning with `solution`. It ends
  // when the residual, in the preconditioner's norm, is less than `tolerance` times the right side.
  // Returns the number of iterations, at most 200.
  int Solve(const std::vector<float>& right, double tolerance, std::vector<float>* solution);

 private:
  void Factor();
  // Both return the product of `from` and `to`.
  double Precondition(const std::vector<float>& from, std::vector<float>* to) const;
  double Apply(const std::vector<float>& from, std::vector<float>* to) const;

  std::vector<Links> down_, up_;
  std::vector<std::size_t> blocks_;  // each preconditioned separately, in parallel
  std::vector<float> diagonal_;
  std::vector<float> inverse_pivot_;  // inverse diagonal of the incomplete Cholesky factor
  std::vector<float> residual_, direction_, image_, better_;
};

}  // namespace thunderhead::renderers
