// Downsamples a storm for devices that cannot hold all of its cells.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// The downsampling factor of each axis with which the drawn part of `fields`, with its border, has
// at most `max_cells` cells along the axis; 1 where none is needed.
glm::ivec3 CoarseningFor(const HydrometeorFields& fields, int max_cells);

// Means over blocks of `factor` cells: each field keeps its mass and, by cell, its extinction.
// Parts of blocks beyond the domain count as empty. Terrain and statistics are not copied.
HydrometeorFields Coarsened(const HydrometeorFields& fields, const glm::ivec3& factor);

}  // namespace thunderhead::volume
