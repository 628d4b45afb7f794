// The light scattering of randomly oriented hexagonal ice crystals much larger than the wavelength,
// by geometric optics. Rays are traced through the crystal with Fresnel's equations and split at
// every face. The traced rays account for half of the extinction. The other half is diffraction by
// the crystal's shadow. Sources: Wendling, Wendling and Weickmann 1979 (Appl. Opt. 18, 2663);
// Macke, Mueller and Raschke 1996 (J. Atmos. Sci. 53, 2813).
//
// Roughness follows Macke et al. and Yang and Liou 1998 (Contrib. Atmos. Phys. 71, 223). Each time
// a ray meets a face, the face is tilted at random. The tilt has normally distributed slopes along
// two axes.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/chunked_work.h"
#include "physics/phase_accumulator.h"
#include "physics/phase_table.h"

namespace thunderhead::physics {

// A hexagonal prism. `width_um` is the distance between opposite edges, `length_um` is along the
// axis. `roughness` is the root mean square slope of the faces' tilts. It is 0 for a pristine
// crystal.
struct IceCrystal {
  double width_um;
  double length_um;
  double roughness = 0.0;
};

// The energy of the traced rays by destination. The shares add up to 1.
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

// Traces `rays` rays that hit crystals of random orientation. The rays are spread evenly over the
// crystals' shadows. The same seed gives the same bits for any number of threads.
RayScattering TraceRays(const IceCrystal& crystal, const std::vector<double>& angles_deg,
                        std::int64_t rays, std::uint64_t seed, const WorkPlan& plan);

// Returns the Fraunhofer diffraction by the shadows of randomly oriented crystals, by angle up to
// 90 degrees. Each crystal is weighted by the area of its shadow.
PhaseAccumulator Diffract(const IceCrystal& crystal, const std::vector<double>& angles_deg,
                          int orientations, std::uint64_t seed, const WorkPlan& plan);

// Returns the phase function of traced rays and diffraction together. Diffraction also spreads the
// light that passed straight through the crystal, as an aperture of about the shadow's size would.
std::vector<PhaseRgb> PhaseOf(const RayScattering& rays, const PhaseAccumulator& diffraction,
                              const std::vector<double>& angles_deg);

}  // namespace thunderhead::physics
