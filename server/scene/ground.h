// The ground of a scene on its storm's fields: what of its look can be drawn, and how bright it is.
// Knows no GL.
#pragma once

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::scene {

// The look as it is drawn on these fields.
Ground DrawnGround(const Scene& scene, const volume::HydrometeorFields& fields);

// The scene with the albedo of the ground that is drawn: the mean of the file's where land use is
// drawn, else the scene's own. It is what lights the storm and the air.
Scene WithGroundOf(Scene scene, const volume::HydrometeorFields& fields);

// Reflectance by colour of plain ground: bare soil and grass seen from far off. The albedo is that
// of red.
glm::vec3 PlainReflectance(const Scene& scene);

// The middle of the rings: that of the storm's condensate.
glm::dvec2 RingMiddle_m(const volume::HydrometeorFields& fields);

}  // namespace thunderhead::scene
