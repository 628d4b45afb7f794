#include "accuracy/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "base/status.h"

namespace thunderhead::accuracy {
namespace {

// Student's t at 97.5 % for kGroups - 1 = 39 degrees of freedom.
constexpr double kStudent = 2.0227;
constexpr std::int64_t kMinPixels = 160;

double MeanOf(const glm::dvec3& color) { return (color.x + color.y + color.z) / 3.0; }

}  // namespace

ErrorEstimate::Sums ErrorEstimate::Sums::operator-(const Sums& other) const {
  return {pixels - other.pixels, squared_error - other.squared_error, truth - other.truth,
          difference - other.difference};
}

void ErrorEstimate::Sums::operator+=(const Sums& other) {
  pixels += other.pixels;
  squared_error += other.squared_error;
  truth += other.truth;
  difference += other.difference;
}

void ErrorEstimate::Add(const glm::dvec3& drawn, std::span<const glm::dvec3> estimates) {
  const auto count = static_cast<double>(estimates.size());
  THUNDERHEAD_CHECK(estimates.size() >= 2, "a pixel needs two estimates");
  glm::dvec3 sum(0.0);
  glm::dvec3 squares(0.0);
  for (const glm::dvec3& estimate : estimates) {
    const glm::dvec3 off = estimate - drawn;
    sum += off;
    squares += off * off;
  }
  const double squared_error = MeanOf((sum * sum - squares) / (count * (count - 1.0)));
  const double variance = std::max(MeanOf((squares - sum * sum / count) / (count - 1.0)), 0.0);
  const glm::dvec3 mean_off = sum / count;
  groups_[static_cast<std::size_t>(pixels_) % kGroups] +=
      {1.0, squared_error, MeanOf(drawn + mean_off), -MeanOf(mean_off)};
  ++pixels_;
  paths_ += static_cast<std::int64_t>(estimates.size());
  variance_squares_ += variance * variance;
  error_squares_ += squared_error * squared_error;
  pair_noise_ += 2.0 * variance * variance / (count * (count - 1.0)) +
                 4.0 * std::max(squared_error, 0.0) * variance / count;
}

ErrorEstimate::Ratios ErrorEstimate::RatiosOf(const Sums& sums) {
  const double truth = sums.truth / sums.pixels;
  return {sums.squared_error / sums.pixels / (truth * truth), sums.difference / sums.truth};
}

std::optional<MeasuredError> ErrorEstimate::Result() const {
  Sums all;
  for (const Sums& group : groups_) all += group;
  if (pixels_ < kMinPixels || !(all.truth > 0.0)) return std::nullopt;
  const Ratios whole = RatiosOf(all);
  // Tukey's jackknife: the ratios without each of the groups.
  constexpr double kCount = kGroups;
  Ratios squares;
  for (const Sums& group : groups_) {
    const Ratios without = RatiosOf(all - group);
    squares.squared_rmse += std::pow(without.squared_rmse - whole.squared_rmse, 2);
    squares.bias += std::pow(without.bias - whole.bias, 2);
  }
  const double share = (kCount - 1.0) / kCount;
  const double squared_reach = kStudent * std::sqrt(share * squares.squared_rmse);
  const double bias_reach = kStudent * std::sqrt(share * squares.bias);
  const auto root = [](double square) { return std::sqrt(std::max(square, 0.0)); };
  MeasuredError error;
  error.relative_rmse = {root(whole.squared_rmse), root(whole.squared_rmse - squared_reach),
                         root(whole.squared_rmse + squared_reach)};
  error.relative_bias = {whole.bias, whole.bias - bias_reach, whole.bias + bias_reach};
  error.paths = paths_;
  return error;
}

// With k paths through each of P / k pixels the variance of the mean squared error is about
// (2 V / (k - 1) + k E) / P plus what does not depend on k, where V is the mean square of the
// paths' variance and E the variance of the squared error from pixel to pixel.
int ErrorEstimate::BestPathsPerPixel(int most) const {
  const double pixels = std::max(static_cast<double>(pixels_), 1.0);
  Sums all;
  for (const Sums& group : groups_) all += group;
  const double mean = all.squared_error / pixels;
  const double between = (error_squares_ - pair_noise_) / pixels - mean * mean;
  const double paths_noise = 2.0 * variance_squares_ / pixels;
  if (!(paths_noise > 0.0)) return 2;
  if (!(between > 0.0)) return most;
  const double best = 1.0 + std::sqrt(paths_noise / between);
  return static_cast<int>(std::clamp(best, 2.0, static_cast<double>(most)));
}

}  // namespace thunderhead::accuracy
