// The first hit of a ray from an eye: the storm, the ground, or neither. For pointing at a picture.
#pragma once

#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// The place where half of the cloud's share of what is seen along the ray lies before it: in a
// dense cloud at an optical depth of ln 2, in thin cloud over the ground farther in. Where the ray
// meets nearly no cloud (an optical depth below 0.1) it is the ground; and in the clear sky the
// point of the ray that is nearest to the storm's middle. `direction` has the length 1. Without
// turbulent detail.
glm::dvec3 PlaceSeen(const Scene& scene, const volume::HydrometeorFields& fields,
                     const glm::dvec3& origin_m, const glm::dvec3& direction);

}  // namespace thunderhead::scene
