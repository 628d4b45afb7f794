// Approximates the region in which a field exceeds a level by balls inside that region. The
// algorithm is greedy: it always takes the largest ball that fits and whose centre no earlier ball
// covers. The balls' union nearly fills the region. In thin layers, flat ellipsoids are used
// instead of balls. This code does not depend on storms or GL.
#pragma once

#include <vector>

#include "clouds/cumulus_surface.h"
#include "volume/grid.h"

namespace thunderhead::clouds {

struct InscribedBallsOptions {
  float level = 0.0F;  // cells with a larger value are inside the region
  int max_balls = 900;
  double spacing = 0.62;  // earlier balls are scaled by this factor; a new ball's centre must lie
                          // outside them
};

// Returns the balls as bubbles with their parents and outward directions. `values` has
// grid.CellCount() values, x fastest. The result is empty if no value is above the level.
CumulusSurface InscribedBalls(const volume::RegularGrid& grid, const std::vector<float>& values,
                              const InscribedBallsOptions& options);

// Computes the distance transform: for each cell, the distance in metres from its centre to the
// centre of the nearest cell whose value is not above `level`. Cells outside the grid count as not
// above the level. One pass along each axis suffices (Felzenszwalb and Huttenlocher 2012).
std::vector<float> DistanceInside_m(const volume::RegularGrid& grid,
                                    const std::vector<float>& values, float level);

}  // namespace thunderhead::clouds
