#include "clouds/output_weights.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::clouds {
namespace {

constexpr int kGainOver = 10;  // number of iterations over which the decrease of H is measured
constexpr int kPowerIterations = 16;

// The factor by which the computed largest eigenvalue is increased, because the power method
// underestimates it. A step that is too long would overshoot.
constexpr double kStepMargin = 1.05;

double SumOfSquares(const std::vector<float>& field) {
  double sum = 0.0;
  for (const float value : field) sum += static_cast<double>(value) * static_cast<double>(value);
  return sum;
}

double Dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

bool GainsLittle(const std::vector<double>& errors, double min_gain) {
  if (errors.size() <= kGainOver) return false;
  const double before = errors[errors.size() - 1 - kGainOver];
  return before - errors.back() <= min_gain * before;
}

// Returns the largest eigenvalue of A^T A, by the power method.
double LargestEigenvalue(const BasisOperator& basis, std::size_t balls) {
  std::vector<double> vector(balls, 1.0 / std::sqrt(static_cast<double>(balls)));
  std::vector<double> image;
  std::vector<float> field;
  double eigenvalue = 0.0;
  for (int i = 0; i < kPowerIterations; ++i) {
    basis.Apply(vector, &field);
    basis.ApplyTransposed(field, &image);
    eigenvalue = std::sqrt(Dot(image, image));
    if (eigenvalue == 0.0) break;
    for (std::size_t k = 0; k < balls; ++k) vector[k] = image[k] / eigenvalue;
  }
  return eigenvalue;
}

// Computes field = target - A weights.
void Residual(const BasisOperator& basis, const std::vector<float>& target,
              const std::vector<double>& weights, std::vector<float>* field) {
  basis.Apply(weights, field);
  for (std::size_t i = 0; i < target.size(); ++i) (*field)[i] = target[i] - (*field)[i];
}

// Takes projected gradient steps with the step size 1 / (largest eigenvalue). With `momentum`, each
// step starts from extrapolated weights.
OutputWeights Descend(const BasisOperator& basis, const std::vector<float>& target,
                      const WeightOptions& options, bool momentum, const WeightObserver& observer) {
  std::vector<double> sums;
  basis.ApplyTransposed(target, &sums);
  const std::size_t balls = sums.size();
  OutputWeights result{std::vector<double>(balls, 0.0), {SumOfSquares(target)}};
  const double eigenvalue = LargestEigenvalue(basis, balls);
  if (eigenvalue == 0.0) return result;
  const double step = 1.0 / (kStepMargin * eigenvalue);
  std::vector<double> pushed = result.weights;
  std::vector<float> residual = target;
  double speed = 1.0;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    Residual(basis, target, pushed, &residual);
    basis.ApplyTransposed(residual, &sums);
    const double next_speed = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * speed * speed));
    const double push = momentum ? (speed - 1.0) / next_speed : 0.0;
    for (std::size_t k = 0; k < balls; ++k) {
      const double before = result.weights[k];
      double next = pushed[k] + step * sums[k];
      if (options.non_negative) next = std::max(next, 0.0);
      result.weights[k] = next;
      pushed[k] = next + push * (next - before);
    }
    speed = next_speed;
    Residual(basis, target, result.weights, &residual);
    result.errors.push_back(SumOfSquares(residual));
    // Momentum is reset when it increases the error.
    if (momentum && result.errors.back() > result.errors[result.errors.size() - 2]) {
      pushed = result.weights;
      speed = 1.0;
    }
    if (!observer(iteration, result.errors.back())) break;
    if (GainsLittle(result.errors, options.min_gain)) break;
  }
  return result;
}

}  // namespace

OutputWeights ByGradient(const BasisOperator& basis, const std::vector<float>& target,
                         const WeightOptions& options, const WeightObserver& observer) {
  return Descend(basis, target, options, false, observer);
}

OutputWeights ByLeastSquares(const BasisOperator& basis, const std::vector<float>& target,
                             const WeightOptions& options, const WeightObserver& observer) {
  if (options.non_negative) return Descend(basis, target, options, true, observer);
  std::vector<double> diagonal = basis.SquaredNorms();
  for (double& value : diagonal) value = value > 0.0 ? 1.0 / value : 0.0;
  const std::size_t balls = diagonal.size();
  OutputWeights result{std::vector<double>(balls, 0.0), {SumOfSquares(target)}};
  std::vector<float> residual = target;
  std::vector<float> image;
  std::vector<double> sums;
  basis.ApplyTransposed(residual, &sums);
  std::vector<double> scaled(balls);
  const auto scale = [&] {
    for (std::size_t k = 0; k < balls; ++k) scaled[k] = diagonal[k] * sums[k];
    return Dot(sums, scaled);
  };
  double gamma = scale();
  std::vector<double> direction = scaled;
  for (int iteration = 0; iteration < options.max_iterations && gamma > 0.0; ++iteration) {
    basis.Apply(direction, &image);
    const double curvature = SumOfSquares(image);
    if (!(curvature > 0.0)) break;
    const double step = gamma / curvature;
    for (std::size_t k = 0; k < balls; ++k) result.weights[k] += step * direction[k];
    const auto field_step = static_cast<float>(step);
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= field_step * image[i];
    result.errors.push_back(SumOfSquares(residual));
    if (!observer(iteration, result.errors.back())) break;
    if (GainsLittle(result.errors, options.min_gain)) break;
    basis.ApplyTransposed(residual, &sums);
    const double before = gamma;
    gamma = scale();
    for (std::size_t k = 0; k < balls; ++k) {
      direction[k] = scaled[k] + (gamma / before) * direction[k];
    }
  }
  // The final residual is computed anew, because rounding errors accumulate in the residual that
  // the iterations update.
  Residual(basis, target, result.weights, &residual);
  result.errors.back() = SumOfSquares(residual);
  return result;
}

}  // namespace thunderhead::clouds
