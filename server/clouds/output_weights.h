// The third phase of P. Man's method to approximate a field by metaballs (clouds/rbf_fit.h cites
// the paper). It finds the weights of metaballs with which their sum approximates a field best, in
// the sense of least squares. H is the sum of squared differences (eq. 20). This code does not
// depend on the clustering.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "clouds/basis_operator.h"

namespace thunderhead::clouds {

struct WeightOptions {
  bool non_negative = false;
  int max_iterations = 200;
  double min_gain = 1e-4;  // iterations end when H falls by less than this fraction in ten
                           // iterations
};

struct OutputWeights {
  std::vector<double> weights;
  std::vector<double> errors;  // H after each iteration; the first value is H for weights of 0
};

// A function that is called after each iteration with H (`error`). If it returns false, the
// iterations end.
using WeightObserver = std::function<bool(int iteration, double error)>;

// Finds the weights by gradient descent on H (eq. 24), with a step size that cannot overshoot. If
// weights must not be negative, negative weights are set to 0 after each step.
OutputWeights ByGradient(const BasisOperator& basis, const std::vector<float>& target,
                         const WeightOptions& options, const WeightObserver& observer);

// Finds the weights by conjugate gradients on the normal equations, preconditioned by their
// diagonal. If weights must not be negative, it uses projected gradients with momentum (Beck and
// Teboulle 2009).
OutputWeights ByLeastSquares(const BasisOperator& basis, const std::vector<float>& target,
                             const WeightOptions& options, const WeightObserver& observer);

}  // namespace thunderhead::clouds
