// The air that a storm shades. Only in this air do renderers and the path-traced reference subtract
// the light that the storm blocks from the in-scattering.
#pragma once

#include "glm/vec3.hpp"
#include "volume/visible_box.h"

namespace thunderhead::scene {

// Two boxes of shaded air. Air outside a box is lit as if there were no storm.
struct ShadedAir {
  // Air in the storm's shadow: a box around the storm and its shadow, down to the ground.
  volume::WorldBox from_sun;
  // Air from which the storm hides more than about a tenth of the sky's light.
  volume::WorldBox from_sky;
};

// Returns the boxes for a storm whose medium has the bounding box `storm`. `towards_sun` must be a
// unit vector. If the sun is below the horizon, the storm casts no shadow and `from_sun` must not
// be used.
ShadedAir ShadedAirOf(const volume::WorldBox& storm, const glm::dvec3& towards_sun,
                      double ground_m);

}  // namespace thunderhead::scene
