// Downsamples a storm for devices that cannot hold all of its cells.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Returns the downsampling factor of each axis. With it, the drawn part of `fields` and its border
// have at most `max_cells` cells along the axis. The factor is 1 where none is needed.
glm::ivec3 CoarseningFor(const HydrometeorFields& fields, int max_cells);

// Returns means over blocks of `factor` cells. Each field keeps its mass, and its extinction cell
// by cell. Parts of blocks beyond the domain count as empty. Terrain and statistics are not copied.
HydrometeorFields Coarsened(const HydrometeorFields& fields, const glm::ivec3& factor);

}  // namespace thunderhead::volume
