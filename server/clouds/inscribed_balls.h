// Approximates the region where a field exceeds a level by balls inside it: greedily, each time the
// largest that fits and whose centre no earlier one covers. Their union nearly fills the region;
// thin layers get flat ellipsoids. Knows no storm and no GL.
#pragma once

#include <vector>

#include "clouds/cumulus_surface.h"
#include "volume/grid.h"

namespace thunderhead::clouds {

struct InscribedBallsOptions {
  float level = 0.0F;  // cells with more than this are inside
  int max_balls = 900;
  double spacing = 0.62;  // a ball's centre lies outside all earlier balls, scaled by this
};

// `values` has grid.CellCount() values, x fastest. Empty if nothing is above the level; parents and
// outward directions are set.
CumulusSurface InscribedBalls(const volume::RegularGrid& grid, const std::vector<float>& values,
                              const InscribedBallsOptions& options);

// Distance transform: metres from each cell's centre to the centre of the nearest cell that is not
// above the level (as are all cells outside the grid), by one pass along each axis (Felzenszwalb
// and Huttenlocher 2012).
std::vector<float> DistanceInside_m(const volume::RegularGrid& grid,
                                    const std::vector<float>& values, float level);

}  // namespace thunderhead::clouds
