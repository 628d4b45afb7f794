#include "physics/aureole.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "glm/common.hpp"
#include "physics/optics.h"

namespace thunderhead::physics {
namespace {

// Number of rings around the sun among which the light of the forward peak, which delta scaling
// cuts off, is divided. The radii of the rings grow with the square of the index, so the inner
// rings are narrow.
constexpr int kAureoleRings = 600;
// Number of wave numbers of the Hankel transform, and their step in 1/rad. They reach 15 divided by
// the radius of the sun's disc. The phase tables are averaged over the disc, so they contain no
// higher wave numbers. With the default cut angle, the step is so small that aliases appear only
// beyond four times the largest angle.
constexpr int kWaves = 800;
constexpr double kWaveStep = 4.0;

struct Ring {
  double radius = 0.0;
  glm::dvec3 share{0.0};  // share of all scattered light
};

// Returns 2 sin(angle / 2). With this radius, the area of a ring in the plane equals its solid
// angle.
double RingRadius(double angle_rad) { return 2.0 * std::sin(0.5 * angle_rad); }

std::vector<Ring> RingsOf(const PhaseFunction& phase, double cut_rad) {
  const glm::dvec3 held = PhaseColors(phase, std::cos(cut_rad));
  std::vector<Ring> rings;
  for (int i = 0; i < kAureoleRings; ++i) {
    const double from = RingRadius(cut_rad) * std::pow(static_cast<double>(i) / kAureoleRings, 2.0);
    const double to = RingRadius(cut_rad) * std::pow((i + 1.0) / kAureoleRings, 2.0);
    const double radius = 0.5 * (from + to);
    const glm::dvec3 cut =
        glm::max(PhaseColors(phase, 1.0 - 0.5 * radius * radius) - held, glm::dvec3(0.0));
    rings.push_back({radius, cut * (0.25 * (to * to - from * from))});
  }
  return rings;
}

// Returns the transform of the rings at each wave number. At wave number 0, the transform is the
// share of the scattered light that is in the forward peak.
std::vector<glm::dvec3> TransformOf(const std::vector<Ring>& rings) {
  std::vector<glm::dvec3> transform;
  for (int k = 0; k < kWaves; ++k) {
    const double wave = kWaveStep * (k + 0.5);
    glm::dvec3 sum(0.0);
    for (const Ring& ring : rings) sum += ring.share * ::j0(wave * ring.radius);
    transform.push_back(sum);
  }
  return transform;
}

// Returns exp(x) - 1 - x without cancellation.
double TwiceAndMore(double x) {
  return std::abs(x) < 1e-3 ? 0.5 * x * x * (1.0 + x / 3.0) : std::expm1(x) - x;
}

double Squared(int i, int count) {
  const double share = static_cast<double>(i) / (count - 1);
  return share * share;
}

}  // namespace

Aureole Aureole::Of(const PhaseFunction& phase, double cut_rad) {
  Aureole aureole;
  aureole.share = CutForwardPeak(phase, cut_rad).forward_share;
  aureole.end_rad = 2.0 * cut_rad;
  aureole.radiances.assign(static_cast<std::size_t>(kAngles) * kDepths, glm::vec3(0.0F));
  if (aureole.share <= 0.0) return aureole;
  const std::vector<glm::dvec3> transform = TransformOf(RingsOf(phase, cut_rad));
  // Bessel functions by angle, then wave number. They include the factors of the transform's
  // integral.
  std::vector<double> bessel;
  for (int a = 0; a < kAngles; ++a) {
    const double radius = RingRadius(aureole.end_rad * Squared(a, kAngles));
    for (int k = 0; k < kWaves; ++k) {
      const double wave = kWaveStep * (k + 0.5);
      bessel.push_back(::j0(wave * radius) * wave * kWaveStep * 0.5 * std::numbers::inv_pi);
    }
  }
  for (int d = 0; d < kDepths; ++d) {
    const double depth = kMaxDepth * Squared(d, kDepths);
    const double scattered = depth / aureole.share;
    std::vector<glm::dvec3> blurred;
    blurred.reserve(transform.size());
    for (const glm::dvec3& once : transform) {
      blurred.emplace_back(std::exp(-depth) * glm::dvec3(TwiceAndMore(scattered * once.x),
                                                         TwiceAndMore(scattered * once.y),
                                                         TwiceAndMore(scattered * once.z)));
    }
    for (int a = 0; a < kAngles; ++a) {
      glm::dvec3 sum(0.0);
      const double* row = bessel.data() + static_cast<std::ptrdiff_t>(a) * kWaves;
      for (std::size_t k = 0; k < blurred.size(); ++k) sum += row[k] * blurred[k];
      aureole.radiances[static_cast<std::size_t>(d) * kAngles + static_cast<std::size_t>(a)] =
          glm::max(glm::vec3(sum), glm::vec3(0.0F));
    }
  }
  return aureole;
}

}  // namespace thunderhead::physics
