#include "accuracy/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/status.h"

namespace thunderhead::accuracy {
namespace {

// Student's t at 97.5 % for kGroups - 1 = 39 degrees of freedom.
constexpr double kStudent = 2.0227;
constexpr std::int64_t kMinPixels = 160;
// kMinReach is the minimum half width of the error's confidence interval, relative to the error.
// kMinBiasReach is that of the bias, relative to the mean radiance. Both correspond to the
// uncertainty of a reference with 1000 samples per pixel.
constexpr double kMinReach = 0.03;
constexpr double kMinBiasReach = 0.002;

// Returns half the width of the 95 % interval of `whole` by Tukey's jackknife. Each element of
// `without` is the estimate with one group of pixels left out.
double Reach(double whole, const std::vector<double>& without) {
  const auto count = static_cast<double>(without.size());
  double squares = 0.0;
  for (const double each : without) squares += (each - whole) * (each - whole);
  return kStudent * std::sqrt((count - 1.0) / count * squares);
}

// Returns a bound on the bias of the squared error. The bias arises because the light that clamping
// removes from some pixels is added back to all pixels. `lost` is the root mean square of that
// light. The bound assumes the worst case, in which all of the light belongs to pixels whose error
// has the same sign.
double Misplaced(double squared_error, double lost) {
  return 2.0 * std::sqrt(std::max(squared_error, 0.0)) * std::abs(lost) + lost * lost;
}

double MeanOf(const glm::dvec3& color) { return (color.x + color.y + color.z) / 3.0; }

}  // namespace

void PixelReference::Add(const glm::dvec3& estimate) {
  ++paths_;
  const double brightness = MeanOf(estimate) / usual_;
  for (std::size_t i = 0; i < kClamps.size(); ++i) {
    const glm::dvec3 clamped =
        brightness > kClamps[i] ? estimate * (kClamps[i] / brightness) : estimate;
    sums_[i].first += clamped;
    sums_[i].squares += clamped * clamped;
  }
}

ErrorEstimate::Sums ErrorEstimate::Sums::operator-(const Sums& other) const {
  return {reference - other.reference, drawn_reference - other.drawn_reference,
          squared_reference - other.squared_reference};
}

void ErrorEstimate::Sums::operator+=(const Sums& other) {
  reference += other.reference;
  drawn_reference += other.drawn_reference;
  squared_reference += other.squared_reference;
}

ErrorEstimate::Group ErrorEstimate::Group::operator-(const Group& other) const {
  Group rest{pixels - other.pixels, drawn - other.drawn, squared_drawn - other.squared_drawn};
  for (std::size_t i = 0; i < kClamps.size(); ++i) {
    rest.clamped[i] = clamped[i] - other.clamped[i];
  }
  return rest;
}

void ErrorEstimate::Group::operator+=(const Group& other) {
  pixels += other.pixels;
  drawn += other.drawn;
  squared_drawn += other.squared_drawn;
  for (std::size_t i = 0; i < kClamps.size(); ++i) clamped[i] += other.clamped[i];
}

void ErrorEstimate::Add(const glm::dvec3& drawn, const PixelReference& reference) {
  THUNDERHEAD_CHECK(reference.Paths() >= 2, "a pixel needs two paths");
  const auto count = static_cast<double>(reference.Paths());
  const double weight = reference.Weight();
  Group& group = groups_[static_cast<std::size_t>(pixels_) % kGroups];
  group.pixels += 1.0;
  group.drawn += weight * MeanOf(drawn);
  group.squared_drawn += weight * MeanOf(drawn * drawn);
  for (std::size_t i = 0; i < kClamps.size(); ++i) {
    const auto& [first, squares] = reference.Clamped(i);
    const glm::dvec3 mean = first / count;
    const double squared_reference = MeanOf((first * first - squares) / (count * (count - 1.0)));
    group.clamped[i] +=
        {weight * MeanOf(mean), weight * MeanOf(drawn * mean), weight * squared_reference};
    const double squared_error =
        weight * (MeanOf(drawn * drawn) - 2.0 * MeanOf(drawn * mean) + squared_reference);
    const double variance =
        weight * std::max(MeanOf((squares - first * mean) / (count - 1.0)), 0.0);
    noise_[i].squared_error += squared_error;
    noise_[i].variance_squares += variance * variance;
    noise_[i].error_squares += squared_error * squared_error;
    noise_[i].pair_noise += 2.0 * variance * variance / (count * (count - 1.0)) +
                            4.0 * std::max(squared_error, 0.0) * variance / count;
  }
  ++pixels_;
  paths_ += reference.Paths();
}

ErrorEstimate::Group ErrorEstimate::All() const {
  Group all;
  for (const Group& group : groups_) all += group;
  return all;
}

ErrorEstimate::Ratios ErrorEstimate::RatiosOf(const Group& group, std::size_t clamp) const {
  const Sums& clamped = group.clamped[clamp];
  const double whole_reference = group.clamped.back().reference;
  // The light that clamping removes is added back, spread over all pixels, by scaling the reference
  // radiance.
  const double scale = clamped.reference > 0.0 ? whole_reference / clamped.reference : 1.0;
  const double squared_error = group.squared_drawn - 2.0 * scale * clamped.drawn_reference +
                               scale * scale * clamped.squared_reference;
  const double difference = (group.drawn - whole_reference) / group.pixels;
  const double reference = mean_drawn_ - difference;
  return {squared_error / group.pixels / (reference * reference), difference / reference,
          scale - 1.0};
}

std::size_t ErrorEstimate::BestClamp(const Group& all) const {
  std::size_t best = kClamps.size() - 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t clamp = 0; clamp < kClamps.size(); ++clamp) {
    const Ratios whole = RatiosOf(all, clamp);
    std::vector<double> without;
    for (const Group& group : groups_) {
      without.push_back(RatiosOf(all - group, clamp).squared_rmse);
    }
    const double reach =
        Reach(whole.squared_rmse, without) + Misplaced(whole.squared_rmse, whole.lost);
    if (reach < least) {
      least = reach;
      best = clamp;
    }
  }
  return best;
}

std::optional<MeasuredError> ErrorEstimate::Result() const {
  const Group all = All();
  // The left side minus the right is the sum of the estimated reference radiances. It must be
  // positive, because errors are relative to their mean.
  if (pixels_ < kMinPixels ||
      !(mean_drawn_ * all.pixels > all.drawn - all.clamped.back().reference)) {
    return std::nullopt;
  }
  const std::size_t clamp = BestClamp(all);
  const Ratios whole = RatiosOf(all, clamp);
  std::vector<double> squared_errors;
  std::vector<double> biases;
  for (const Group& group : groups_) {
    const Ratios without = RatiosOf(all - group, clamp);
    squared_errors.push_back(without.squared_rmse);
    biases.push_back(without.bias);
  }
  const double squared_reach = Reach(whole.squared_rmse, squared_errors) +
                               Misplaced(whole.squared_rmse, whole.lost) +
                               2.0 * kMinReach * std::max(whole.squared_rmse, 0.0);
  const double bias_reach = Reach(whole.bias, biases) + kMinBiasReach;
  const auto root = [](double square) { return std::sqrt(std::max(square, 0.0)); };
  MeasuredError error;
  error.relative_rmse = {root(whole.squared_rmse), root(whole.squared_rmse - squared_reach),
                         root(whole.squared_rmse + squared_reach)};
  error.relative_bias = {whole.bias, whole.bias - bias_reach, whole.bias + bias_reach};
  error.paths = paths_;
  return error;
}

// With k paths through each of P / k pixels, the variance of the mean squared error is about (2 V /
// (k - 1) + k E) / P plus a constant. V is the mean square of the paths' variance. E is the
// variance of the squared error from pixel to pixel.
int ErrorEstimate::BestPathsPerPixel(int most) const {
  const double pixels = std::max(static_cast<double>(pixels_), 1.0);
  const Noise& noise = noise_[BestClamp(All())];
  const double mean = noise.squared_error / pixels;
  const double between = (noise.error_squares - noise.pair_noise) / pixels - mean * mean;
  const double paths_noise = 2.0 * noise.variance_squares / pixels;
  if (!(paths_noise > 0.0)) return 2;
  if (!(between > 0.0)) return most;
  const double best = 1.0 + std::sqrt(paths_noise / between);
  return static_cast<int>(std::clamp(best, 2.0, static_cast<double>(most)));
}

}  // namespace thunderhead::accuracy
