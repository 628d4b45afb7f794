// The air that a storm shades. Renderers and the reference subtract the missing light only from
// in-scattering in this air.
#pragma once

#include "glm/vec3.hpp"
#include "volume/visible_box.h"

namespace thunderhead::scene {

// Boxes of shaded air. The clear sky and the sun light all air outside both boxes.
struct ShadedAir {
  volume::WorldBox from_sun;  // around the storm and its shadow, down to the ground
  // Around the places from which the storm hides a large part of the sky.
  volume::WorldBox from_sky;
};

// Returns the boxes for a medium with the bounding box `storm`. `towards_sun` must be a unit
// vector. If the sun is below the horizon, it lights no air.
ShadedAir ShadedAirOf(const volume::WorldBox& storm, const glm::dvec3& towards_sun,
                      double ground_m);

}  // namespace thunderhead::scene
