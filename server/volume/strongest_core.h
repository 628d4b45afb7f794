// Finds the strongest core of a storm, for a camera to look at. A scene chooses only the source of
// the particles' sizes; the other optics are the defaults. This code does not depend on scenes.
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
  // Returns the usual width of a tower of this height.
  double Radius_m() const { return 0.25 * Height_m(); }
};

// Returns the place where the optical depth of columns is largest. The depth is smoothed over a
// quarter of the storm's height, at most 3 km, so that no single column decides. Cloud water
// dominates optical depth, so the place is an updraught and not the rain next to it. The top is the
// highest within half the storm's height, because a tower in shear leans. Returns nothing if there
// is no condensate.
std::optional<StormCore> StrongestCore(const HydrometeorFields& fields,
                                       physics::SizeSource sizes = physics::SizeSource::kModel);

}  // namespace thunderhead::volume
