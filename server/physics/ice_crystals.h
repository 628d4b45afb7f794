// The light scattering of randomly oriented hexagonal ice crystals much larger than the wavelength,
// by geometric optics. Rays are traced through the crystal with Fresnel's equations and split at
// every face. Diffraction by the crystal's shadow contributes the other half of the extinction.
// Sources: Wendling, Wendling and Weickmann 1979 (Appl. Opt. 18, 2663); Macke, Mueller and Raschke
// 1996 (J. Atmos. Sci. 53, 2813).
//
// Roughness follows Macke et al. and Yang and Liou 1998 (Contrib. Atmos. Phys. 71, 223). At each
// encounter the face is tilted at random, with normally distributed slopes along two axes.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/chunked_work.h"
#include "physics/phase_accumulator.h"
#include "physics/phase_table.h"

namespace thunderhead::physics {

// A hexagonal prism. The width is from edge to edge, the length along the axis. `roughness` is the
// root mean square slope of the faces' tilts. A pristine crystal has roughness 0.
struct IceCrystal {
  double width_um;
  double length_um;
  double roughness = 0.0;
};

// Shares of the traced rays' energy by destination. They sum to 1.
struct RayBudget {
  PhaseRgb reflected{};  // reflected by the outside of the crystal
  PhaseRgb straight{};   // left exactly in the incident direction, through parallel faces
  PhaseRgb scattered{};  // left in other directions
  PhaseRgb left{};       // still inside when tracing stopped
};

struct RayScattering {
  PhaseAccumulator light;  // reflected and scattered light, by angle
  RayBudget budget;
};

// Traces `rays` rays into crystals of random orientation, spread over the crystals' shadows. The
// same seed gives the same bits for any number of threads.
RayScattering TraceRays(const IceCrystal& crystal, const std::vector<double>& angles_deg,
                        std::int64_t rays, std::uint64_t seed, const WorkPlan& plan);

// Returns the Fraunhofer diffraction by the shadows of randomly oriented crystals, by angle up to
// 90 degrees. Each crystal is weighted by the area of its shadow.
PhaseAccumulator Diffract(const IceCrystal& crystal, const std::vector<double>& angles_deg,
                          int orientations, std::uint64_t seed, const WorkPlan& plan);

// Returns the phase function of rays and diffraction together. Diffraction also spreads light that
// came straight through, as an aperture of about the shadow's size would.
std::vector<PhaseRgb> PhaseOf(const RayScattering& rays, const PhaseAccumulator& diffraction,
                              const std::vector<double>& angles_deg);

}  // namespace thunderhead::physics
