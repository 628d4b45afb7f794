// The strongest core of a storm, for a camera to look at. Of the optics
// only the particles' sizes are a scene's; knows no scene.
#pragma once

#include <optional>

#include "glm/vec2.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

struct StormCore {
  glm::dvec2 place_m{0.0};
  double ground_m = 0.0;  // above sea level, under the core
  double top_m = 0.0;     // of the cloud around it, above sea level

  double Height_m() const { return top_m - ground_m; }
  // A tower's usual width for its height.
  double Radius_m() const { return 0.25 * Height_m(); }
};

// The place where the optical depth of columns is largest, smoothed over a quarter of the storm's
// height and at most 3 km, so that no single column decides. Cloud water makes up most of an
// optical depth, so this is an updraught rather than the rain beside it. The top is the highest
// within half the storm's height, since a tower in shear leans. Nothing if there is no condensate.
std::optional<StormCore> StrongestCore(const HydrometeorFields& fields,
                                       physics::SizeSource sizes = physics::SizeSource::kModel);

}  // namespace thunderhead::volume
