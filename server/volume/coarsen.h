// Downsamples a storm for devices that cannot hold all of its cells.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Returns the downsampling factor of each axis. After downsampling by these factors, the part of
// `fields` with condensate and its border of empty cells have at most `max_cells` cells along each
// axis. The factor is 1 along an axis that is short enough.
glm::ivec3 CoarseningFor(const HydrometeorFields& fields, int max_cells);

// Returns means over blocks of `factor` cells. Each field keeps its total mass and its total
// extinction. The parts of blocks that lie beyond the domain count as empty. Only the fields'
// values and sizes and the air's motion are kept. Terrain, land, borders, air density and
// statistics are empty.
HydrometeorFields Coarsened(const HydrometeorFields& fields, const glm::ivec3& factor);

}  // namespace thunderhead::volume
