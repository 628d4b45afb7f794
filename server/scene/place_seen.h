// The first hit of a ray from an eye: the storm, the ground, or neither. The page uses it to point
// at places in a picture.
#pragma once

#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// Returns the place that a viewer sees along the ray. In cloud it is the point with half of the
// cloud's visible contribution in front of it. In a dense cloud that is at an optical depth of ln
// 2. In a thin cloud it is at about half of the cloud's optical depth. A ray with an optical depth
// below 0.1 sees the ground behind. In the clear sky the result is the point of the ray nearest to
// the storm's middle. `direction` must have the length 1. The medium has no turbulent detail.
glm::dvec3 PlaceSeen(const Scene& scene, const volume::HydrometeorFields& fields,
                     const glm::dvec3& origin_m, const glm::dvec3& direction);

}  // namespace thunderhead::scene
