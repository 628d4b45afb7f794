// Approximates any field on a grid by a sum of metaballs, with the method of P. Man, "Generating
// and Real-Time Rendering of Clouds" (docs/clouds.md). The method trains a network of radial basis
// functions in three phases (eq. 11-24). The paper leaves the third phase, the output weights, to
// future work. Here the weights are found by the paper's gradient rule (kGradient) or by least
// squares with conjugate gradients (kDirect). The result is the same for any number of threads.
#pragma once

#include <functional>
#include <stop_token>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "clouds/metaballs.h"
#include "volume/grid.h"

namespace thunderhead::clouds {

enum class Solver { kGradient, kDirect };

struct FitOptions {
  int balls = 1000;
  Basis basis = Basis::kGaussian;
  double overlap = 2.5;  // u of eq. 16; the paper uses 2
  Solver solver = Solver::kDirect;
  bool non_negative = false;  // weights are 0 or more
  int max_iterations = 200;   // maximum for the third phase
  double min_gain = 1e-4;     // the third phase ends when H falls by less than this fraction in ten
                              // iterations
  std::uint64_t seed = 1;
  int threads = 0;  // number of threads; 0 means one for each processor
};

// Progress of the fit. `error` is H of eq. 20, or 0 before the third phase.
struct FitProgress {
  std::string_view phase;
  double share = 0.0;  // share of this phase that is done
  double error = 0.0;
};

struct FitResult {
  MetaballCloud cloud;
  double error = 0.0;           // H of eq. 20, over all cells of the box, including empty cells
  double relative_error = 0.0;  // square root of H divided by the sum of the squared values
  std::vector<double> errors;   // H after each iteration of the third phase
  std::size_t cells = 0;        // number of cells in the box, K of eq. 20
  std::size_t cloudy_cells = 0;
  int epochs = 0;  // number of epochs of the first phase
};

// Approximates `values`, one for each cell of `grid`, x fastest, none negative. Returns
// INVALID_ARGUMENT if an option is out of range, no value is above 0, or there are more balls than
// cells above 0. If `stop` requests it, returns the best result so far, or CANCELLED if no centres
// were found yet.
absl::StatusOr<FitResult> Fit(const volume::RegularGrid& grid, const std::vector<float>& values,
                              const FitOptions& options,
                              const std::function<void(const FitProgress&)>& observer,
                              const std::stop_token& stop);

// Returns the sum of all balls at every cell's centre, x fastest. Negative sums are set to zero.
std::vector<float> Evaluate(const MetaballCloud& cloud, const volume::RegularGrid& grid,
                            int threads);

}  // namespace thunderhead::clouds
