// The ground of a scene as it is drawn for the fields of its storm: its cover, borders and
// brightness. This code does not use GL.
#pragma once

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// Returns the scene's ground without the parts for which these fields have no data, such as land
// use or borders.
Ground DrawnGround(const Scene& scene, const volume::HydrometeorFields& fields);

// Returns the scene with Sky::ground_albedo set to the albedo of the ground that is drawn. This
// albedo lights the storm and the air. It is the mean over the file's land use if the land use is
// drawn, otherwise the scene's own albedo.
Scene WithGroundOf(Scene scene, const volume::HydrometeorFields& fields);

// Returns the reflectance in red, green and blue of plain ground, which is bare soil and grass seen
// from far away. The scene's ground albedo is the red reflectance.
glm::vec3 PlainReflectance(const Scene& scene);

// Returns the centre of the distance rings, which is the middle of the storm's condensate.
glm::dvec2 RingMiddle_m(const volume::HydrometeorFields& fields);

// Returns the unit vector to true north in the middle of the domain. The arrow of the distance
// rings points there.
glm::dvec2 TrueNorth(const volume::HydrometeorFields& fields);

}  // namespace thunderhead::scene
