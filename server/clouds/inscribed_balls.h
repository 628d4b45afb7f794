// The shape of a field on a grid as balls inside it: the largest that fits first, then the largest
// whose middle no earlier one covers, and so on. Their union nearly fills what is above a level;
// thin layers get flat ellipsoids. Knows no storm and no GL.
#pragma once

#include <vector>

#include "clouds/cumulus_surface.h"
#include "volume/grid.h"

namespace thunderhead::clouds {

struct InscribedBallsOptions {
  float level = 0.0F;  // cells with more than this are inside
  int most_balls = 900;
  double spacing = 0.62;  // a ball's middle lies outside every earlier one shrunk to this
};

// `values` has grid.CellCount() values, x fastest. Empty if nothing is above the level; parents and
// outward directions are set.
CumulusSurface InscribedBalls(const volume::RegularGrid& grid, const std::vector<float>& values,
                              const InscribedBallsOptions& options);

// Distance in metres from each cell's middle to the middle of the nearest cell that is not above
// the level, the outside of the grid counted as such: Felzenszwalb and Huttenlocher 2012, a pass
// along each axis.
std::vector<float> DistanceInside_m(const volume::RegularGrid& grid,
                                    const std::vector<float>& values, float level);

}  // namespace thunderhead::clouds
