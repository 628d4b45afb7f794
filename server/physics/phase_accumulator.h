// A histogram of scattered light by angle, from which a phase table is made. A ray's energy is
// divided between the two nearest angles of the grid. The table is linear between its angles, so it
// holds exactly the energy that was added. Both ray tracing and quadrature over the angle use this
// class.
#pragma once

#include <cstddef>
#include <vector>

#include "physics/phase_table.h"

namespace thunderhead::physics {

// A part of the angle grid. It ends at `end_deg`, and its angles are `step_deg` apart.
struct GridSpan {
  double end_deg;
  double step_deg;
};

// Returns the angles of consecutive spans, beginning at 0. The last span must end at 180 degrees.
// The length of each span must be a multiple of its step.
std::vector<double> AngleGrid(const std::vector<GridSpan>& spans);

class PhaseAccumulator {
 public:
  explicit PhaseAccumulator(const std::vector<double>& angles_deg);

  // Adds light scattered by `angle_rad`.
  void Add(double angle_rad, double energy, std::size_t channel);

  // Adds all energies of another accumulator of the same grid, multiplied by `factor` in each
  // channel.
  void Add(const PhaseAccumulator& other, const PhaseRgb& factor);

  // Returns the sum of all added energies.
  const PhaseRgb& energy() const { return energy_; }

  // Returns the phase function of the added light, one value for each angle. Its mean over the
  // sphere is 1.
  std::vector<PhaseRgb> Values() const;

 private:
  std::vector<double> angles_rad_;
  std::vector<PhaseRgb> energies_;
  PhaseRgb energy_{};
};

// Quadrature over sin(angle) d(angle) from 0 to pi: Gauss-Legendre with `order` points between each
// two neighbouring angles of the grid.
struct AngleQuadrature {
  std::vector<double> angles_rad;
  std::vector<double> weights;  // include the factor sin(angle); their sum is 2
};
AngleQuadrature QuadratureOf(const std::vector<double>& angles_deg, int order);

// Points and weights of Gauss-Legendre quadrature on [-1, 1].
struct GaussLegendre {
  explicit GaussLegendre(int order);
  std::vector<double> points;
  std::vector<double> weights;
};

}  // namespace thunderhead::physics
