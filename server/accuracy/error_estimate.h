// Estimates a picture's error. The input is independent estimates of the reference radiance (traced
// by the Monte Carlo reference) of some of its pixels. Errors are relative RMSE and bias, as
// measure/image_error.h defines them. Each error has a 95 % confidence interval
// (docs/decisions/0051-measured-error.md). This code does not depend on scenes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "glm/vec3.hpp"

namespace thunderhead::accuracy {

// An estimated value and its 95 % confidence interval.
struct Estimated {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;

  bool operator==(const Estimated&) const = default;
};

struct MeasuredError {
  Estimated relative_rmse;  // 0 or more
  Estimated relative_bias;  // positive if the picture is too bright
  std::int64_t paths = 0;

  bool operator==(const MeasuredError&) const = default;
};

// The multiples of a pixel's usual radiance at which the radiance of paths is clamped. Clamping is
// necessary because a few paths are a hundred times brighter than the rest, which makes sums of
// squares unreliable. The light that clamping removes is added back, spread evenly over the pixels.
// All multiples are tried; the last one clamps nothing.
inline constexpr std::array<double, 8> kClamps = {4.0, 6.0, 9.0, 13.0, 20.0, 30.0, 60.0, 1e300};

// The sums of independent, almost unbiased estimates of the reference radiance of one pixel.
class PixelReference {
 public:
  struct Sums {
    glm::dvec3 first{0.0};
    glm::dvec3 squares{0.0};
  };

  // `usual` is the pixel's approximate radiance, above 0. `weight` says how many of the picture's
  // pixels this pixel represents, relative to the mean. It equals 1 / (number of pixels x
  // probability of choosing this pixel).
  explicit PixelReference(double usual, double weight = 1.0) : usual_(usual), weight_(weight) {}

  void Add(const glm::dvec3& estimate);

  double Weight() const { return weight_; }
  std::int64_t Paths() const { return paths_; }
  // Returns the sums over the estimates, each clamped at kClamps[clamp] times the usual radiance.
  const Sums& Clamped(std::size_t clamp) const { return sums_[clamp]; }

 private:
  double usual_;
  double weight_;
  std::int64_t paths_ = 0;
  std::array<Sums, kClamps.size()> sums_{};
};

class ErrorEstimate {
 public:
  // `mean_drawn` is the mean of the drawn radiance over all pixels and colours. Because this mean
  // is known exactly, only the difference between drawn and reference radiance is estimated.
  explicit ErrorEstimate(double mean_drawn) : mean_drawn_(mean_drawn) {}

  // Adds a pixel with at least two paths. The paths' noise does not count as error. The squared
  // error is estimated by the product of the differences from `drawn` of two different paths,
  // averaged over all pairs. This estimate is unbiased (a U-statistic).
  void Add(const glm::dvec3& drawn, const PixelReference& reference);

  // Returns nothing for fewer than 160 pixels, or while the estimated mean reference radiance is
  // not above 0.
  std::optional<MeasuredError> Result() const;

  // Returns the number of paths per pixel, 2 to `most`, with which the same total number of paths
  // would have given the smallest variance. It is large if pixels have similar errors and paths are
  // noisy, and small if errors differ from pixel to pixel.
  int BestPathsPerPixel(int most) const;

  std::int64_t Pixels() const { return pixels_; }

 private:
  // Weighted sums over pixels of means over colours. The reference radiance is estimated from
  // clamped paths.
  struct Sums {
    double reference = 0.0;          // sum of reference radiance
    double drawn_reference = 0.0;    // sum of drawn times reference radiance
    double squared_reference = 0.0;  // sum of squared reference radiance, without the paths' noise

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
  // The results from the sums of a group: the squared relative RMSE, the relative bias, and the
  // share of the light that clamping removes.
  struct Ratios {
    double squared_rmse = 0.0;
    double bias = 0.0;
    double lost = 0.0;
  };
  // Sums over pixels for BestPathsPerPixel.
  struct Noise {
    double squared_error = 0.0;
    double variance_squares = 0.0;
    double error_squares = 0.0;
    double pair_noise = 0.0;  // the part of `error_squares` that is caused by the paths' noise
  };

  Group All() const;
  Ratios RatiosOf(const Group& group, std::size_t clamp) const;
  // Returns the clamp with the narrowest interval, including the bias that clamping may cause.
  std::size_t BestClamp(const Group& all) const;

  // The number of groups of pixels for the jackknife. Pixels are assigned to the groups in turn.
  static constexpr std::size_t kGroups = 40;

  double mean_drawn_;
  std::array<Group, kGroups> groups_{};
  std::array<Noise, kClamps.size()> noise_{};
  std::int64_t pixels_ = 0;
  std::int64_t paths_ = 0;
};

}  // namespace thunderhead::accuracy
