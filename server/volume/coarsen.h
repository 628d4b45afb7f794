// A storm on fewer cells, for devices that cannot hold all of them.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// How many cells must become one along each axis so that what is drawn of `fields`, with a border,
// has at most `most_cells` along it. 1, 1, 1 if it has.
glm::ivec3 CoarseningFor(const HydrometeorFields& fields, int most_cells);

// Means over blocks of `factor` cells: each field keeps its mass and, by cell, its extinction.
// Blocks that reach beyond the domain count what lies there as empty. Terrain and statistics are
// not carried over.
HydrometeorFields Coarsened(const HydrometeorFields& fields, const glm::ivec3& factor);

}  // namespace thunderhead::volume
