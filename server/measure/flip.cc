// FLIP by Andersson et al. 2020, for pictures of low dynamic range. The constants are those of the
// paper.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "base/srgb.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/mat3x3.hpp"
#include "glm/matrix.hpp"
#include "measure/image_error.h"

namespace thunderhead::measure {
namespace {

constexpr double kPixelsPerDegree = 67.0;
constexpr double kColorExponent = 0.7;       // q_c
constexpr double kFeatureExponent = 0.5;     // q_f
constexpr double kCutOff = 0.4;              // p_c
constexpr double kCutOffValue = 0.95;        // p_t
constexpr double kFeatureWidth_deg = 0.082;  // width of an edge that the eye detects

// Three colour planes of a picture.
struct Planes {
  glm::ivec2 size{0};
  std::vector<glm::dvec3> values;

  const glm::dvec3& At(int x, int y) const {
    x = std::clamp(x, 0, size.x - 1);
    y = std::clamp(y, 0, size.y - 1);
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) +
                  static_cast<std::size_t>(x)];
  }
};

Planes Mapped(const Planes& planes, const std::function<glm::dvec3(const glm::dvec3&)>& map) {
  Planes mapped{planes.size, {}};
  mapped.values.reserve(planes.values.size());
  for (const glm::dvec3& value : planes.values) mapped.values.push_back(map(value));
  return mapped;
}

// Matrix from linear sRGB to CIE XYZ under D65. Its columns are for red, green and blue.
const glm::dmat3 kXyzFromRgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920,
                             0.1804375, 0.0721750, 0.9503041);
const glm::dvec3 kWhite = kXyzFromRgb * glm::dvec3(1.0);

// Returns opponent colours (luminance, red-green, blue-yellow). They are linear in radiance, so
// that filters can be applied to them.
glm::dvec3 OpponentOf(const glm::dvec3& rgb) {
  const glm::dvec3 xyz = kXyzFromRgb * rgb / kWhite;
  return {116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)};
}

glm::dvec3 RgbOf(const glm::dvec3& opponent) {
  const double y = (opponent.x + 16.0) / 116.0;
  const glm::dvec3 xyz(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
  return glm::inverse(kXyzFromRgb) * (xyz * kWhite);
}

// Returns CIE L*a*b* with the Hunt effect, by which dim colours have less chroma.
glm::dvec3 LabOf(const glm::dvec3& rgb) {
  const glm::dvec3 xyz = kXyzFromRgb * rgb / kWhite;
  const auto f = [](double t) {
    constexpr double kDelta = 6.0 / 29.0;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29.0;
  };
  const double l = 116.0 * f(xyz.y) - 16.0;
  return {l, 0.01 * l * 500.0 * (f(xyz.x) - f(xyz.y)), 0.01 * l * 200.0 * (f(xyz.y) - f(xyz.z))};
}

double HybridDistance(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 d = a - b;
  return std::abs(d.x) + std::hypot(d.y, d.z);
}

// A filter of one colour plane, which is the sum of two separable Gaussians.
struct Gaussians {
  double a1, b1, a2, b2;

  double At(double squared_deg) const {
    constexpr double kPi = std::numbers::pi;
    const auto term = [&](double a, double b) {
      return a * std::sqrt(kPi / b) * std::exp(-kPi * kPi * squared_deg / b);
    };
    return term(a1, b1) + term(a2, b2);
  }
};
constexpr std::array<Gaussians, 3> kContrastSensitivity = {
    {{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};

Planes Filtered(const Planes& planes) {
  const int radius = static_cast<int>(std::ceil(
      3.0 * std::sqrt(0.04 / (2.0 * std::numbers::pi * std::numbers::pi)) * kPixelsPerDegree));
  const int side = 2 * radius + 1;
  std::vector<glm::dvec3> weights(static_cast<std::size_t>(side * side));
  glm::dvec3 total(0.0);
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) {
      const double squared_deg = (x * x + y * y) / (kPixelsPerDegree * kPixelsPerDegree);
      glm::dvec3& weight = weights[static_cast<std::size_t>((y + radius) * side + x + radius)];
      for (int c = 0; c < 3; ++c) {
        weight[c] = kContrastSensitivity[static_cast<std::size_t>(c)].At(squared_deg);
      }
      total += weight;
    }
  }
  Planes filtered{planes.size, {}};
  filtered.values.reserve(planes.values.size());
  for (int py = 0; py < planes.size.y; ++py) {
    for (int px = 0; px < planes.size.x; ++px) {
      glm::dvec3 sum(0.0);
      std::size_t i = 0;
      for (int y = -radius; y <= radius; ++y) {
        for (int x = -radius; x <= radius; ++x) sum += weights[i++] * planes.At(px + x, py + y);
      }
      filtered.values.push_back(sum / total);
    }
  }
  return filtered;
}

std::vector<double> ColorDifference(const Planes& image, const Planes& reference) {
  const auto seen = [](const Planes& opponent) {
    return Mapped(Filtered(opponent), [](const glm::dvec3& value) {
      return LabOf(glm::clamp(RgbOf(value), 0.0, 1.0));
    });
  };
  const Planes a = seen(image);
  const Planes b = seen(reference);
  const double max_distance =
      std::pow(HybridDistance(LabOf({0.0, 1.0, 0.0}), LabOf({0.0, 0.0, 1.0})), kColorExponent);
  std::vector<double> difference;
  difference.reserve(a.values.size());
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double distance = std::pow(HybridDistance(a.values[i], b.values[i]), kColorExponent);
    const double cut = kCutOff * max_distance;
    difference.push_back(distance < cut ? kCutOffValue / cut * distance
                                        : kCutOffValue + (distance - cut) / (max_distance - cut) *
                                                             (1.0 - kCutOffValue));
  }
  return difference;
}

// One-dimensional kernels: a Gaussian, and its first or second derivative. The positive weights of
// the derivative add up to 1, and so do the absolute values of its negative weights.
struct Kernels {
  std::vector<double> smooth, derivative;
};

Kernels KernelsOf(bool edges) {
  const double deviation = 0.5 * kFeatureWidth_deg * kPixelsPerDegree;
  const int radius = static_cast<int>(std::ceil(3.0 * deviation));
  Kernels kernels;
  double smooth = 0.0;
  double positive = 0.0;
  double negative = 0.0;
  for (int x = -radius; x <= radius; ++x) {
    const double t = x / deviation;
    const double gaussian = std::exp(-0.5 * t * t);
    const double derivative = edges ? -t * gaussian : (t * t - 1.0) * gaussian;
    kernels.smooth.push_back(gaussian);
    kernels.derivative.push_back(derivative);
    smooth += gaussian;
    (derivative > 0.0 ? positive : negative) += std::abs(derivative);
  }
  for (double& weight : kernels.smooth) weight /= smooth;
  for (double& weight : kernels.derivative) weight /= weight > 0.0 ? positive : negative;
  return kernels;
}

// Returns the strength of edges (if `edges` is true) or points at each pixel, from luminance.
std::vector<double> Features(const Planes& opponent, bool edges) {
  const Kernels kernels = KernelsOf(edges);
  const int radius = static_cast<int>(kernels.smooth.size() / 2);
  // x is the luminance smoothed horizontally, y its horizontal derivative.
  Planes rows{opponent.size, std::vector<glm::dvec3>(opponent.values.size())};
  std::vector<double> strength(opponent.values.size());
  const auto each = [&](const auto& visit) {
    std::size_t at = 0;
    for (int y = 0; y < opponent.size.y; ++y) {
      for (int x = 0; x < opponent.size.x; ++x) visit(x, y, at++);
    }
  };
  each([&](int x, int y, std::size_t at) {
    for (int i = -radius; i <= radius; ++i) {
      const double luminance = (opponent.At(x + i, y).x + 16.0) / 116.0;
      rows.values[at].x += kernels.smooth[static_cast<std::size_t>(i + radius)] * luminance;
      rows.values[at].y += kernels.derivative[static_cast<std::size_t>(i + radius)] * luminance;
    }
  });
  each([&](int x, int y, std::size_t at) {
    double across = 0.0;
    double along = 0.0;
    for (int i = -radius; i <= radius; ++i) {
      across += kernels.smooth[static_cast<std::size_t>(i + radius)] * rows.At(x, y + i).y;
      along += kernels.derivative[static_cast<std::size_t>(i + radius)] * rows.At(x, y + i).x;
    }
    strength[at] = std::hypot(across, along);
  });
  return strength;
}

Planes OpponentOf(const frame::RgbImage& image) {
  Planes planes{{image.width_px, image.height_px}, {}};
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    planes.values.push_back(OpponentOf(glm::dvec3(base::LinearOfSrgbByte(image.rgb[i]),
                                                  base::LinearOfSrgbByte(image.rgb[i + 1]),
                                                  base::LinearOfSrgbByte(image.rgb[i + 2]))));
  }
  return planes;
}

}  // namespace

double Flip(const frame::RgbImage& image, const frame::RgbImage& reference) {
  THUNDERHEAD_CHECK(image.width_px == reference.width_px && image.height_px == reference.height_px,
                    std::to_string(image.width_px));
  const Planes a = OpponentOf(image);
  const Planes b = OpponentOf(reference);
  const std::vector<double> color = ColorDifference(a, b);
  const std::vector<double> edges_a = Features(a, true);
  const std::vector<double> edges_b = Features(b, true);
  const std::vector<double> points_a = Features(a, false);
  const std::vector<double> points_b = Features(b, false);
  double sum = 0.0;
  for (std::size_t i = 0; i < color.size(); ++i) {
    const double feature =
        std::max(std::abs(edges_a[i] - edges_b[i]), std::abs(points_a[i] - points_b[i]));
    const double share = std::pow(feature / std::numbers::sqrt2, kFeatureExponent);
    sum += std::pow(color[i], 1.0 - std::min(share, 1.0));
  }
  return sum / static_cast<double>(color.size());
}

}  // namespace thunderhead::measure
