// The height of the ground under a storm. Beyond the domain it is that of the nearest point of its
// edge.
#pragma once

#include "glm/vec2.hpp"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Height above sea level at a place in world metres, linear between the middles of the columns.
double TerrainHeight_m(const HydrometeorFields& fields, const glm::dvec2& place_m);

// The lowest ground of the domain.
double LowestTerrain_m(const HydrometeorFields& fields);

}  // namespace thunderhead::volume
