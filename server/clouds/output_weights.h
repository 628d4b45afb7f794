// The third phase of Man's approximator: the metaballs' weights that approximate a field best, by
// least squares. This code does not depend on the clustering.
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

// A function that is called after each iteration with H. If it returns false, the iteration ends.
using WeightObserver = std::function<bool(int iteration, double error)>;

// Finds the weights by gradient descent on H (eq. 24), with a step size that cannot overshoot. If
// weights must not be negative, each step ends with a projection.
OutputWeights ByGradient(const BasisOperator& basis, const std::vector<float>& target,
                         const WeightOptions& options, const WeightObserver& observer);

// Finds the weights by conjugate gradients on the normal equations, preconditioned by their
// diagonal. If weights must not be negative, it uses projected gradients with momentum (Beck and
// Teboulle 2009).
OutputWeights ByLeastSquares(const BasisOperator& basis, const std::vector<float>& target,
                             const WeightOptions& options, const WeightObserver& observer);

}  // namespace thunderhead::clouds
