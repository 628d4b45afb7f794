// The third phase of Man's approximator: the metaballs' weights that approximate a field best, by
// least squares. Knows no clustering.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "clouds/basis_operator.h"

namespace thunderhead::clouds {

struct WeightOptions {
  bool non_negative = false;
  int max_iterations = 200;
  double min_gain = 1e-4;  // ends when H falls by less than this share in ten iterations
};

struct OutputWeights {
  std::vector<double> weights;
  std::vector<double> errors;  // H after each iteration; the first is that of no balls at all
};

// Called after each iteration with H; false ends it.
using WeightObserver = std::function<bool(int iteration, double error)>;

// Eq. 24: gradient descent on H, with a step size that cannot overshoot. Non-negative weights are
// kept so by projection after each step.
OutputWeights ByGradient(const BasisOperator& basis, const std::vector<float>& target,
                         const WeightOptions& options, const WeightObserver& observer);

// Conjugate gradients on the normal equations, preconditioned by their diagonal; for non-negative
// weights projected gradients with momentum (Beck and Teboulle 2009).
OutputWeights ByLeastSquares(const BasisOperator& basis, const std::vector<float>& target,
                             const WeightOptions& options, const WeightObserver& observer);

}  // namespace thunderhead::clouds
