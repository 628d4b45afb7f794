// The light scattering of many water drops: Mie theory averaged over a distribution of their sizes.
#pragma once

#include "physics/chunked_work.h"
#include "physics/phase_accumulator.h"
#include "physics/phase_table.h"

namespace thunderhead::physics {

// The gamma distribution of droplet radii with effective radius a and effective variance b. The
// source is Hansen and Travis 1974 (Space Sci. Rev. 16, 527), eq. 2.56: n(r) ~ r^((1 - 3 b) / b)
// exp(-r / (a b)).
struct DropletSizes {
  double effective_radius_um;
  double effective_variance;
};

// Radii and their shares of the geometric cross section, which add up to 1. The radii are `count`
// Gauss-Legendre points in the logarithm of the radius. Sizes outside the range of these radii have
// less than 1e-5 of the cross section.
struct SizeQuadrature {
  std::vector<double> radii_um;
  std::vector<double> area_shares;
};
SizeQuadrature QuadratureOf(const DropletSizes& sizes, int count);

// Extinction efficiency, albedo and asymmetry of the whole distribution in each colour channel. The
// efficiency is relative to the geometric cross section. The quadrature over sizes has `radii`
// points.
struct DropletOptics {
  PhaseRgb extinction{};
  PhaseRgb albedo{};
  PhaseRgb asymmetry{};
};
DropletOptics OpticsOf(const DropletSizes& sizes, int radii);

// Returns the extinction of 1 kg of drops, in m2/kg, from their mean extinction efficiency.
double MassExtinction_m2_per_kg(const DropletSizes& sizes, double efficiency);

// Returns the light that water drops scatter, by angle, at kWavelengthsUm. The quadrature over
// sizes has `radii` points. The quadrature over angles has `points` points in each step of
// `angles_deg`. `shift_um` is added to all three wavelengths.
PhaseAccumulator ScatterByDroplets(const DropletSizes& sizes, const std::vector<double>& angles_deg,
                                   int radii, int points, const WorkPlan& plan,
                                   double shift_um = 0.0);

}  // namespace thunderhead::physics
