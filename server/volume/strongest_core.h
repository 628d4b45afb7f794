// Finds the strongest core of a storm, for a camera to look at. Particle radii come from the size
// source that the scene chooses; all other optical properties are the defaults. This code does not
// depend on scenes.
#pragma once

#include <optional>

#include "glm/vec2.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

struct StormCore {
  glm::dvec2 place_m{0.0};
  double ground_m = 0.0;  // above sea level, under the core
  double top_m = 0.0;     // top of the surrounding cloud, above sea level

  double Height_m() const { return top_m - ground_m; }
  // Returns the radius that a tower of this height usually has.
  double Radius_m() const { return 0.25 * Height_m(); }
};

// Returns the core at the column with the largest vertical optical depth. The depth is smoothed
// over a quarter of the storm's height, at most 3 km, so that no single column decides. Cloud water
// dominates optical depth, so the core is an updraught and not the rain next to it. Its top is the
// highest cloud top within a horizontal distance of half the storm's height, because a tower leans
// in wind shear. Returns nothing if there is no condensate.
std::optional<StormCore> StrongestCore(const HydrometeorFields& fields,
                                       physics::SizeSource sizes = physics::SizeSource::kModel);

}  // namespace thunderhead::volume
