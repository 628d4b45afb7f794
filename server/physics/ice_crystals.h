// The light scattering of randomly oriented hexagonal ice crystals much larger than the wavelength,
// by geometric optics: rays are traced through the crystal with Fresnel's equations and split at
// every face; diffraction by the crystal's shadow carries the other half of the extinction.
// Wendling, Wendling and Weickmann 1979 (Appl. Opt. 18, 2663); Macke, Mueller and Raschke 1996 (J.
// Atmos. Sci. 53, 2813).
//
// Roughness, after Macke et al. and Yang and Liou 1998 (Contrib. Atmos. Phys. 71, 223): at each
// encounter the face is tilted at random, its two slopes normal variates.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/chunked_work.h"
#include "physics/phase_accumulator.h"
#include "physics/phase_table.h"

namespace thunderhead::physics {

// A hexagonal prism: width from edge to edge, length along the axis. `roughness` is the root mean
// square slope of the faces' tilts; 0 is a pristine crystal.
struct IceCrystal {
  double width_um;
  double length_um;
  double roughness = 0.0;
};

// Shares of the traced rays' energy by where it went; they sum to 1.
struct RayBudget {
  PhaseRgb reflected{};  // by the outside of the crystal
  PhaseRgb straight{};   // came out exactly straight on, through parallel faces
  PhaseRgb scattered{};  // came out in other directions
  PhaseRgb left{};       // still inside when tracing stopped
};

struct RayScattering {
  PhaseAccumulator light;  // reflected and scattered light, by angle
  RayBudget budget;
};

// Traces `rays` rays into crystals of random orientation, spread over their shadows. The same seed
// gives the same bits whatever the number of threads.
RayScattering TraceRays(const IceCrystal& crystal, const std::vector<double>& angles_deg,
                        std::int64_t rays, std::uint64_t seed, const WorkPlan& plan);

// Fraunhofer diffraction by the shadows of randomly oriented crystals, each weighted by its area,
// by angle up to 90 degrees.
PhaseAccumulator Diffract(const IceCrystal& crystal, const std::vector<double>& angles_deg,
                          int orientations, std::uint64_t seed, const WorkPlan& plan);

// The phase function of both together. Light that came straight through is spread by diffraction
// too, as through an aperture of about the shadow's size.
std::vector<PhaseRgb> PhaseOf(const RayScattering& rays, const PhaseAccumulator& diffraction,
                              const std::vector<double>& angles_deg);

}  // namespace thunderhead::physics
