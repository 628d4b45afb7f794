// Estimates a picture's error from independent estimates of the true radiance of some of its
// pixels: relative RMSE and bias, as measure/image_error.h defines them, each with the interval
// that holds it in 95 of 100 cases. Plain values; knows no scene.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

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
  Estimated relative_rmse;  // 0 and more
  Estimated relative_bias;  // above 0: the picture is too bright
  std::int64_t paths = 0;

  bool operator==(const MeasuredError&) const = default;
};

class ErrorEstimate {
 public:
  // Adds a pixel, chosen at random or evenly over the picture. `estimates` of its true radiance are
  // independent and unbiased, at least two; their noise does not count as error: the mean product
  // of two different ones' distances from `drawn` is the square of the true radiance's (a
  // U-statistic).
  void Add(const glm::dvec3& drawn, std::span<const glm::dvec3> estimates);

  // None before 160 pixels, or while their mean radiance is not above 0.
  std::optional<MeasuredError> Result() const;

  // The number of paths through each pixel that would have given the smallest variance for the
  // paths traced so far: many where the pixels' errors are alike and paths are noisy, few where
  // errors differ from pixel to pixel. At least 2.
  int BestPathsPerPixel(int most) const;

  std::int64_t Pixels() const { return pixels_; }

 private:
  // Sums over pixels, each of the mean over colours.
  struct Sums {
    double pixels = 0.0;
    double squared_error = 0.0;
    double truth = 0.0;
    double difference = 0.0;  // drawn - truth

    Sums operator-(const Sums& other) const;
    void operator+=(const Sums& other);
  };
  // Of the sums: the squared relative RMSE and the relative bias.
  struct Ratios {
    double squared_rmse = 0.0;
    double bias = 0.0;
  };
  static Ratios RatiosOf(const Sums& sums);

  // Pixels are dealt out to groups in turn, for the jackknife.
  static constexpr std::size_t kGroups = 40;

  std::array<Sums, kGroups> groups_{};
  std::int64_t pixels_ = 0;
  std::int64_t paths_ = 0;
  // For BestPathsPerPixel: sums over pixels of the paths' variance, squared, and of the squared
  // error's estimate, squared.
  double variance_squares_ = 0.0;
  double error_squares_ = 0.0;
  double pair_noise_ = 0.0;  // what of `error_squares_` is the paths' noise
};

}  // namespace thunderhead::accuracy
