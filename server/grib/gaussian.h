// Reads Gaussian grids (template 3.40), whose latitudes are the zeros of a Legendre polynomial. The
// rows of a reduced grid have fewer points towards the poles.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "grib/grid.h"
#include "grib/octets.h"

namespace thunderhead::grib {

// The largest number of parallels between a pole and the equator that is read.
inline constexpr int kMostParallels = 4000;

// Returns `count` latitudes from north to south of the Gaussian grid with `parallels` parallels
// between a pole and the equator. Their sines are the zeros of the Legendre polynomial of the
// degree 2 * parallels. They are accurate to 1e-9 degrees. The index of the first of them is
// `first`, 0 at the north pole. Only the indices from 0 to 2 * parallels - 1 exist.
std::vector<double> GaussianLatitudes_deg(int parallels, int first, int count);

// Reads section 3 of a Gaussian grid. The rows of a regular grid are treated as evenly spaced. If
// that moves a row by more than 0.1 % of the distance between rows, grid.assumptions states the
// largest error. A reduced grid has cells (Grid::cell_rows). Returns INVALID_ARGUMENT for a grid
// that this code does not support, and DATA_LOSS if the grid's numbers contradict each other.
absl::StatusOr<Grid> ReadGaussian(const Octets& section);

}  // namespace thunderhead::grib
