// The height of the ground under a storm. Beyond the domain, the ground has the height of the
// nearest point of the domain's edge. Without terrain in the file, the ground is the domain's low
// face.
#pragma once

#include "glm/vec2.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Returns the height above sea level at a place in world metres, linear between the centres of
// columns.
double TerrainHeight_m(const HydrometeorFields& fields, const glm::dvec2& place_m);

// Returns the lowest height of the ground in the domain.
double LowestTerrain_m(const HydrometeorFields& fields);

}  // namespace thunderhead::volume
