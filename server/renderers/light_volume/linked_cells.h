// Cells that exchange diffuse light with their six neighbours. They form a symmetric linear system,
// which preconditioned conjugate gradients solve. This code knows only conductances between cells,
// not optics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderers/light_volume/numbered_cells.h"

namespace thunderhead::renderers {

// A cell's links in the negative or the positive direction of the three axes. Both kinds are stored
// separately, because the solver reads first all links of one kind and is limited by memory access.
struct Links {
  std::int32_t to[3];  // number of the neighbour; NumberedCells::kNone outside the medium
  float conductance[3];
};

class LinkedCells {
 public:
  LinkedCells() = default;
  // Creates the system from the links of each numbered cell. Both ends of a link have the same
  // conductance. `loss` is the conductance by which each cell loses further light. `blocks` is
  // NumberedCells::Blocks().
  LinkedCells(std::vector<Links> down, std::vector<Links> up, const std::vector<float>& loss,
              std::vector<std::size_t> blocks);

  // Returns the links that contain side `side` (0 to 5) of cell `n`. Even sides are in the negative
  // direction of an axis, odd sides in the positive.
  const Links& LinksOf(std::size_t n, int side) const { return side % 2 == 1 ? up_[n] : down_[n]; }

  const Links& Up(std::size_t n) const { return up_[n]; }

  // Solves for the value of each cell, where `right` is the light that enters each cell. The
  // iteration begins with `solution`. It ends when the residual, in the preconditioner's norm, is
  // less than `tolerance` times the right side. Returns the number of iterations, at most 200.
  int Solve(const std::vector<float>& right, double tolerance, std::vector<float>* solution);

 private:
  void Factor();
  // Precondition and Apply compute `to` from `from`, and return the dot product of the two.
  double Precondition(const std::vector<float>& from, std::vector<float>* to) const;
  double Apply(const std::vector<float>& from, std::vector<float>* to) const;

  std::vector<Links> down_, up_;
  // Blocks of cells that are preconditioned separately, in parallel.
  std::vector<std::size_t> blocks_;
  std::vector<float> diagonal_;
  std::vector<float> inverse_pivot_;  // inverse diagonal of the incomplete Cholesky factor
  std::vector<float> residual_, direction_, image_, better_;
};

}  // namespace thunderhead::renderers
