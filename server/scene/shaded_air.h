// The air that a storm shades: where renderers and the reference look for light that is missing
// from what the air sends to the eye.
#pragma once

#include "glm/vec3.hpp"
#include "volume/visible_box.h"

namespace thunderhead::scene {

// Air outside both boxes counts as lit by the clear sky.
struct ShadedAir {
  volume::WorldBox from_sun;  // around the storm and its shadow, down to the ground
  volume::WorldBox from_sky;  // around where the storm hides a good part of the sky
};

// `storm` is the box around the medium; `towards_sun` a unit vector. With the sun below the horizon
// no air is lit by it.
ShadedAir ShadedAirOf(const volume::WorldBox& storm, const glm::dvec3& towards_sun,
                      double ground_m);

}  // namespace thunderhead::scene
