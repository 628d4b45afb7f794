// The ground of a scene for the fields of its storm: which cover can be drawn, and how bright the
// ground is. This code does not use GL.
#pragma once

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// Returns the scene's ground, reduced to what can be drawn for these fields.
Ground DrawnGround(const Scene& scene, const volume::HydrometeorFields& fields);

// Returns the scene with the albedo of the ground that is drawn, which lights the storm and the
// air. The albedo is the mean of the file's land use if that is drawn, otherwise the scene's own.
Scene WithGroundOf(Scene scene, const volume::HydrometeorFields& fields);

// Returns the reflectance by colour of plain ground: bare soil and grass seen from far away. The
// albedo is that of red.
glm::vec3 PlainReflectance(const Scene& scene);

// Returns the centre of the distance rings, which is the middle of the storm's condensate.
glm::dvec2 RingMiddle_m(const volume::HydrometeorFields& fields);

}  // namespace thunderhead::scene
