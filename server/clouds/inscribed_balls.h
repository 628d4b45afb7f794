// Approximates the region where a field exceeds a level by balls inside it. The algorithm is
// greedy: it always takes the largest ball that fits and whose centre no earlier ball covers. The
// balls' union nearly fills the region. Thin layers get flat ellipsoids. This code does not depend
// on storms or GL.
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

// Returns the balls with their parents and outward directions. `values` has grid.CellCount()
// values, x fastest. The result is empty if nothing is above the level.
CumulusSurface InscribedBalls(const volume::RegularGrid& grid, const std::vector<float>& values,
                              const InscribedBallsOptions& options);

// Computes the distance transform. For each cell it is the distance in metres to the centre of the
// nearest cell that is not above the level. All cells outside the grid count as not above it. One
// pass along each axis suffices (Felzenszwalb and Huttenlocher 2012).
std::vector<float> DistanceInside_m(const volume::RegularGrid& grid,
                                    const std::vector<float>& values, float level);

}  // namespace thunderhead::clouds
