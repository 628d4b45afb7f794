// Diffraction by the shadow of a crystal: Diffract() of ice_crystals.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "glm/geometric.hpp"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "physics/counter_random.h"
#include "physics/hexagonal_prism.h"
#include "physics/ice_crystals.h"
#include "physics/refractive_index.h"

namespace thunderhead::physics {
namespace {

using glm::dvec2;
using glm::dvec3;
using Complex = std::complex<double>;

constexpr int kOutlineChunks = 64;

double Cross(const dvec2& a, const dvec2& b) { return a.x * b.y - a.y * b.x; }

double Sinc(double x) { return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x; }

double AreaOf(const std::vector<dvec2>& polygon) {
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    area += 0.5 * Cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  }
  return area;
}

// Returns the outline of the crystal's shadow, counter-clockwise. It is the convex hull of the
// corners' projections.
std::vector<dvec2> ShadowOf(const HexagonalPrism& prism, const dvec3& direction) {
  const dvec3 x = glm::normalize(glm::cross(
      direction, std::abs(direction.z) < 0.7 ? dvec3(0.0, 0.0, 1.0) : dvec3(1.0, 0.0, 0.0)));
  const dvec3 y = glm::cross(direction, x);
  std::vector<dvec2> points;
  for (const std::size_t base : {std::size_t{6}, std::size_t{7}}) {
    for (const dvec3& corner : prism.Corners(base)) {
      points.emplace_back(glm::dot(corner, x), glm::dot(corner, y));
    }
  }
  std::sort(points.begin(), points.end(),
            [](const dvec2& a, const dvec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  // Andrew's monotone chain computes the lower hull from left to right, then the upper hull from
  // right to left.
  std::vector<dvec2> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const dvec2& point : points) {
      while (hull.size() >= start + 2 &&
             Cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// Returns the integral of exp(-i q.r) over the polygon, as a sum over its edges.
Complex FourierTransform(const std::vector<dvec2>& polygon, double area, const dvec2& q,
                         double size) {
  const double q2 = glm::dot(q, q);
  // For small q the sum is a difference of large numbers. The transform is flat there, so its value
  // at q = 0 is used.
  if (q2 * size * size < 1e-8) return area;
  Complex sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const dvec2& a = polygon[i];
    const dvec2& b = polygon[(i + 1) % polygon.size()];
    const double phase = 0.5 * glm::dot(q, a + b);
    sum += Cross(q, b - a) * Sinc(0.5 * glm::dot(q, b - a)) *
           Complex(std::cos(phase), -std::sin(phase));
  }
  return sum * Complex(0.0, 1.0) / q2;
}

}  // namespace

PhaseAccumulator Diffract(const IceCrystal& crystal, const std::vector<double>& angles_deg,
                          int orientations, std::uint64_t seed, const WorkPlan& plan) {
  const HexagonalPrism prism(crystal.width_um, crystal.length_um);
  const double size = crystal.width_um + crystal.length_um;
  AngleQuadrature angles = QuadratureOf(angles_deg, 3);
  const auto ahead =
      std::upper_bound(angles.angles_rad.begin(), angles.angles_rad.end(), 0.5 * std::numbers::pi);
  angles.angles_rad.erase(ahead, angles.angles_rad.end());
  std::vector<PhaseAccumulator> parts(kOutlineChunks, PhaseAccumulator(angles_deg));
  ForEachChunk(kOutlineChunks, plan, [&](int chunk) {
    PhaseAccumulator& part = parts[static_cast<std::size_t>(chunk)];
    for (int i = chunk; i < orientations; i += kOutlineChunks) {
      CounterRandom random(seed, static_cast<std::uint64_t>(i));
      const double z = 2.0 * random.Next() - 1.0;
      const double azimuth = 2.0 * std::numbers::pi * random.Next();
      const double radius = std::sqrt(1.0 - z * z);
      const dvec3 direction(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
      const std::vector<dvec2> shadow = ShadowOf(prism, direction);
      const double area = AreaOf(shadow);
      for (std::size_t j = 0; j < angles.angles_rad.size(); ++j) {
        // One random azimuth of scattering for each angle is enough, because the random
        // orientations cover all azimuths.
        const double turn = 2.0 * std::numbers::pi * random.Next();
        const double sine = std::sin(angles.angles_rad[j]);
        for (std::size_t c = 0; c < kPhaseChannels; ++c) {
          const double wave_number = 2.0 * std::numbers::pi / kWavelengthsUm[c];
          const dvec2 q = wave_number * sine * dvec2(std::cos(turn), std::sin(turn));
          // |F|^2 k^2 / (4 pi^2) is the energy scattered into unit solid angle for light of unit
          // irradiance. It is multiplied by 2 pi for all azimuths, and by the obliquity factor ((1
          // + cos) / 2)^2.
          const double slant = 0.5 * (1.0 + std::cos(angles.angles_rad[j]));
          const double energy = std::norm(FourierTransform(shadow, area, q, size)) * wave_number *
                                wave_number / (2.0 * std::numbers::pi) * slant * slant;
          part.Add(angles.angles_rad[j], energy * angles.weights[j], c);
        }
      }
    }
  });
  PhaseAccumulator whole(angles_deg);
  for (const PhaseAccumulator& part : parts) whole.Add(part, {1.0, 1.0, 1.0});
  return whole;
}

}  // namespace thunderhead::physics
