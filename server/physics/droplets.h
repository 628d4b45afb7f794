// The light scattering of many drops of water: Mie theory averaged over a distribution of their
// sizes.
#pragma once

#include "physics/chunked_work.h"
#include "physics/phase_accumulator.h"
#include "physics/phase_table.h"

namespace thunderhead::physics {

// The gamma distribution by effective radius and effective variance; Hansen and Travis 1974 (Space
// Sci. Rev. 16, 527), eq. 2.56: n(r) ~ r^((1 - 3 b) / b) exp(-r / (a b)).
struct DropletSizes {
  double effective_radius_um;
  double effective_variance;
};

// Radii and their shares of the geometric cross section, which sum to 1: `count` Gauss-Legendre
// points in the logarithm of the radius, that leave out less than 1e-5 of the cross section.
struct SizeQuadrature {
  std::vector<double> radii_um;
  std::vector<double> area_shares;
};
SizeQuadrature QuadratureOf(const DropletSizes& sizes, int count);

// Efficiencies, albedo and asymmetry of the whole, per geometric cross section, in each channel.
struct DropletOptics {
  PhaseRgb extinction{};
  PhaseRgb albedo{};
  PhaseRgb asymmetry{};
};
DropletOptics OpticsOf(const DropletSizes& sizes, int radii);

// Extinction of 1 kg of drops, in m2/kg, from their mean extinction efficiency.
double MassExtinction_m2_per_kg(const DropletSizes& sizes, double efficiency);

// The light that water drops scatter, by angle, at kWavelengthsUm. `radii` and `points` (within
// each step of the grid) set the fineness of the quadratures over size and angle. `shift_um` is
// added to all three wavelengths.
PhaseAccumulator ScatterByDroplets(const DropletSizes& sizes, const std::vector<double>& angles_deg,
                                   int radii, int points, const WorkPlan& plan,
                                   double shift_um = 0.0);

}  // namespace thunderhead::physics
