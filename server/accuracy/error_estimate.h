// Estimates a picture's error from independent estimates of the reference radiance of some of its
// pixels. Errors are relative RMSE and bias, as measure/image_error.h defines them. Each has a 95 %
// confidence interval (docs/decisions/0051-measured-error.md). Plain values; knows no scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "glm/vec3.hpp"

namespace thunderhead::accuracy {

// A value and its 95 % interval.
struct Estimated {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;

  bool operator==(const Estimated&) const = default;
};

struct MeasuredError {
  Estimated relative_rmse;  // 0 or more
  Estimated relative_bias;  // above 0: the picture is too bright
  std::int64_t paths = 0;

  bool operator==(const MeasuredError&) const = default;
};

// Paths are clamped at these multiples of their pixel's usual radiance. A few paths are a hundred
// times brighter than the rest, and squares of so few paths are unreliable. Clamped paths lose a
// little light, which is added back evenly. The last multiple clamps nothing.
inline constexpr std::array<double, 8> kClamps = {4.0, 6.0, 9.0, 13.0, 20.0, 30.0, 60.0, 1e300};

// Independent, almost unbiased estimates of the reference radiance of one pixel.
class PixelTruth {
 public:
  struct Sums {
    glm::dvec3 first{0.0};
    glm::dvec3 squares{0.0};
  };

  // `usual` is the pixel's approximate radiance, above 0. `weight` is the number of the picture's
  // pixels that it stands for, divided by the mean of that number. It equals 1 / (number of pixels
  // x probability of choosing this pixel).
  explicit PixelTruth(double usual, double weight = 1.0) : usual_(usual), weight_(weight) {}

  void Add(const glm::dvec3& estimate);

  double Weight() const { return weight_; }
  std::int64_t Paths() const { return paths_; }
  // Returns the sums of the estimates clamped by kClamps[clamp].
  const Sums& Clamped(std::size_t clamp) const { return sums_[clamp]; }

 private:
  double usual_;
  double weight_;
  std::int64_t paths_ = 0;
  std::array<Sums, kClamps.size()> sums_{};
};

class ErrorEstimate {
 public:
  // `mean_drawn` is the mean of the drawn radiance over all pixels and colours. Because it is
  // known, only the difference between drawn and reference radiance is estimated.
  explicit ErrorEstimate(double mean_drawn) : mean_drawn_(mean_drawn) {}

  // Adds a pixel with at least two paths. The paths' noise does not count as error: the mean
  // product of two different paths' differences from `drawn` is an unbiased estimate of the squared
  // error (a U-statistic).
  void Add(const glm::dvec3& drawn, const PixelTruth& truth);

  // Returns none before 160 pixels, or while the mean reference radiance is not above 0.
  std::optional<MeasuredError> Result() const;

  // Returns the number of paths per pixel that would have given the smallest variance for the paths
  // traced so far. It is large if the pixels' errors are alike and paths are noisy, and small if
  // errors differ from pixel to pixel. At least 2.
  int BestPathsPerPixel(int most) const;

  std::int64_t Pixels() const { return pixels_; }

 private:
  // Weighted sums over pixels; each term is the mean over colours. The reference radiance is that
  // of clamped paths.
  struct Sums {
    double truth = 0.0;
    double drawn_truth = 0.0;    // of the product
    double squared_truth = 0.0;  // without the paths' noise

    Sums operator-(const Sums& other) const;
    void operator+=(const Sums& other);
  };
  struct Group {
    double pixels = 0.0;
    double drawn = 0.0;
    double squared_drawn = 0.0;
    std::array<Sums, kClamps.size()> clamped{};

    Group operator-(const Group& other) const;
    void operator+=(const Group& other);
  };
  // Results of the sums: the squared relative RMSE, the relative bias, and the share of the light
  // that clamping removes.
  struct Ratios {
    double squared_rmse = 0.0;
    double bias = 0.0;
    double lost = 0.0;
  };
  // Sums over pixels for BestPathsPerPixel: of the paths' squared variance, and of the square of
  // the squared error's estimate.
  struct Noise {
    double squared_error = 0.0;
    double variance_squares = 0.0;
    double error_squares = 0.0;
    double pair_noise = 0.0;  // the part of `error_squares` that is the paths' noise
  };

  Group All() const;
  Ratios RatiosOf(const Group& group, std::size_t clamp) const;
  // Returns the clamp with the narrowest interval, including the bias that clamping may cause.
  std::size_t BestClamp(const Group& all) const;

  // Number of groups, to which pixels are assigned in turn, for the jackknife.
  static constexpr std::size_t kGroups = 40;

  double mean_drawn_;
  std::array<Group, kGroups> groups_{};
  std::array<Noise, kClamps.size()> noise_{};
  std::int64_t pixels_ = 0;
  std::int64_t paths_ = 0;
};

}  // namespace thunderhead::accuracy
