#include "physics/ice_crystals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "glm/geometric.hpp"
#include "glm/vec3.hpp"
#include "physics/counter_random.h"
#include "physics/fresnel.h"
#include "physics/hexagonal_prism.h"
#include "physics/refractive_index.h"

namespace thunderhead::physics {
namespace {

using glm::dvec3;

constexpr int kCrystalChunks = 128;

// A ray ends when its energy is below kMinEnergy times the initial energy, or when it has met a
// face kMaxEncounters times.
constexpr double kMinEnergy = 1e-5;
constexpr int kMaxEncounters = 200;

// Returns five numbers for a ray, chosen so that the points of all rays fill the unit cube evenly.
// The points follow an additive recurrence. Its step consists of the powers of 1 / r, where r is
// the root of r^6 = r + 1 (Roberts 2018). 64-bit integers keep the recurrence exact.
std::array<double, 5> EvenPoint(std::uint64_t index, std::uint64_t seed) {
  constexpr double kRoot = 1.1347241384015194;
  CounterRandom shift(seed, 0);
  std::array<double, 5> point{};
  double step = 1.0;
  for (double& coordinate : point) {
    step /= kRoot;
    const auto whole = static_cast<std::uint64_t>(std::ldexp(step, 53)) << 11U;
    const double moved = static_cast<double>((whole * index) >> 11U) * 0x1p-53 + shift.Next();
    coordinate = moved < 1.0 ? moved : moved - 1.0;
  }
  return point;
}

// Returns the direction of light in the crystal's frame. Because of the crystal's symmetry, a 24th
// of the sphere covers all orientations.
dvec3 DirectionOf(double u, double v) {
  const double z = -u;
  const double azimuth = v * std::numbers::pi / 6.0;
  const double radius = std::sqrt(1.0 - z * z);
  return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
}

// The point at which a ray enters the crystal. It lies on a lit face, which is chosen in proportion
// to its projected area.
struct Entry {
  std::size_t face;
  dvec3 point;
};

Entry EntryOf(const HexagonalPrism& prism, const dvec3& direction, double choice, double u,
              double v) {
  double rest = choice * prism.ProjectedArea(direction);
  std::size_t chosen = 0;
  for (std::size_t face = 0; face < HexagonalPrism::kFaces; ++face) {
    const double area = -prism.Area(face) * glm::dot(prism.Normal(face), direction);
    if (area <= 0.0) continue;
    chosen = face;
    rest -= area;
    if (rest < 0.0) break;
  }
  return {chosen, prism.PointOn(chosen, u, v)};
}

// Tilts `normal` at random. The slopes of the tilt have a root mean square of `roughness`.
dvec3 Tilted(const dvec3& normal, double roughness, CounterRandom& random) {
  const double slope = roughness * std::sqrt(-std::log(1.0 - random.Next()));
  const double azimuth = 2.0 * std::numbers::pi * random.Next();
  const dvec3 axis = std::abs(normal.z) < 0.7 ? dvec3(0.0, 0.0, 1.0) : dvec3(1.0, 0.0, 0.0);
  const dvec3 a = glm::normalize(glm::cross(normal, axis));
  const dvec3 b = glm::cross(normal, a);
  return glm::normalize(normal + slope * (std::cos(azimuth) * a + std::sin(azimuth) * b));
}

// Returns the reflected and refracted rays at a face with the normal `normal`. If the crystal is
// rough, the face is tilted at random. If a tilt sends either ray to the wrong side of the face,
// another tilt is drawn.
BoundaryRays CrossFace(const PolarizedRay& ray, const dvec3& normal, double index_ratio,
                       double roughness, CounterRandom& random) {
  constexpr int kTries = 20;
  for (int i = 0; roughness > 0.0 && i < kTries; ++i) {
    const dvec3 tilted = Tilted(normal, roughness, random);
    if (glm::dot(ray.direction, tilted) >= -1e-6) continue;
    BoundaryRays rays = CrossBoundary(ray, tilted, index_ratio);
    const bool reflected_back = glm::dot(rays.reflected.direction, normal) > 1e-6;
    const bool refracted_on =
        rays.total_reflection || glm::dot(rays.refracted.direction, normal) < -1e-6;
    if (reflected_back && refracted_on) return rays;
  }
  return CrossBoundary(ray, normal, index_ratio);
}

// Traces single rays through a crystal, and adds the light that leaves the crystal to one colour
// channel of a result.
class Tracer {
 public:
  Tracer(const HexagonalPrism& prism, double roughness, std::size_t channel, RayScattering& result)
      : prism_(prism),
        roughness_(roughness),
        channel_(channel),
        index_(kIceRefractiveIndex[channel]),
        result_(result) {}

  // Traces a ray of energy `weight` from its entry.
  void Trace(const Entry& entry, const dvec3& direction, double weight, CounterRandom random) {
    BoundaryRays rays = CrossFace(UnpolarizedRay(direction), prism_.Normal(entry.face),
                                  1.0 / index_, roughness_, random);
    result_.budget.reflected[channel_] += weight * rays.reflected.Energy();
    Scatter(direction, rays.reflected, weight);
    PolarizedRay inside = rays.refracted;
    dvec3 point = entry.point;
    double energy = inside.Energy();
    for (int i = 0; i < kMaxEncounters && energy > kMinEnergy; ++i) {
      const HexagonalPrism::Exit exit = prism_.ExitOf(point, inside.direction);
      point += exit.distance * inside.direction;
      rays = CrossFace(inside, -prism_.Normal(exit.face), index_, roughness_, random);
      if (!rays.total_reflection) Leave(direction, rays.refracted, weight);
      inside = rays.reflected;
      energy = inside.Energy();
    }
    result_.budget.left[channel_] += weight * energy;
  }

 private:
  void Leave(const dvec3& direction, const PolarizedRay& ray, double weight) {
    const dvec3 change = ray.direction - direction;
    if (glm::dot(change, change) < 1e-18) {
      result_.budget.straight[channel_] += weight * ray.Energy();
      return;
    }
    result_.budget.scattered[channel_] += weight * ray.Energy();
    Scatter(direction, ray, weight);
  }

  void Scatter(const dvec3& direction, const PolarizedRay& ray, double weight) {
    // The arc tangent is accurate for small angles, for which the arc cosine is not.
    const double angle = std::atan2(glm::length(glm::cross(direction, ray.direction)),
                                    glm::dot(direction, ray.direction));
    result_.light.Add(angle, weight * ray.Energy(), channel_);
  }

  const HexagonalPrism& prism_;
  double roughness_;
  std::size_t channel_;
  double index_;
  RayScattering& result_;
};

void Merge(const RayScattering& part, RayScattering& whole) {
  whole.light.Add(part.light, {1.0, 1.0, 1.0});
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    whole.budget.reflected[c] += part.budget.reflected[c];
    whole.budget.straight[c] += part.budget.straight[c];
    whole.budget.scattered[c] += part.budget.scattered[c];
    whole.budget.left[c] += part.budget.left[c];
  }
}

}  // namespace

RayScattering TraceRays(const IceCrystal& crystal, const std::vector<double>& angles_deg,
                        std::int64_t rays, std::uint64_t seed, const WorkPlan& plan) {
  const HexagonalPrism prism(crystal.width_um, crystal.length_um);
  std::vector<RayScattering> parts(kCrystalChunks, {PhaseAccumulator(angles_deg), {}});
  ForEachChunk(kCrystalChunks, plan, [&](int chunk) {
    RayScattering& part = parts[static_cast<std::size_t>(chunk)];
    for (std::int64_t ray = chunk; ray < rays; ray += kCrystalChunks) {
      const auto stream = static_cast<std::uint64_t>(ray) + 1;
      const std::array<double, 5> point = EvenPoint(stream, seed);
      const dvec3 direction = DirectionOf(point[0], point[1]);
      const Entry entry = EntryOf(prism, direction, point[2], point[3], point[4]);
      const double shadow = prism.ProjectedArea(direction);
      for (std::size_t c = 0; c < kPhaseChannels; ++c) {
        // Every channel has the same random tilts. The colours therefore differ only by refraction,
        // not by noise.
        Tracer(prism, crystal.roughness, c, part)
            .Trace(entry, direction, shadow, CounterRandom(seed, stream));
      }
    }
  });
  RayScattering whole{PhaseAccumulator(angles_deg), {}};
  for (const RayScattering& part : parts) Merge(part, whole);
  RayBudget& budget = whole.budget;
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    const double sum =
        budget.reflected[c] + budget.straight[c] + budget.scattered[c] + budget.left[c];
    THUNDERHEAD_CHECK(sum > 0.0, absl::StrCat(rays, " rays"));
    for (PhaseRgb* share : {&budget.reflected, &budget.straight, &budget.scattered, &budget.left}) {
      (*share)[c] /= sum;
    }
  }
  return whole;
}

std::vector<PhaseRgb> PhaseOf(const RayScattering& rays, const PhaseAccumulator& diffraction,
                              const std::vector<double>& angles_deg) {
  PhaseAccumulator sum(angles_deg);
  PhaseRgb ray_factor{};
  PhaseRgb diffraction_factor{};
  for (std::size_t c = 0; c < kPhaseChannels; ++c) {
    const double spread = rays.budget.reflected[c] + rays.budget.scattered[c];
    ray_factor[c] = 0.5 * spread / rays.light.energy()[c];
    diffraction_factor[c] = 0.5 * (1.0 + rays.budget.straight[c]) / diffraction.energy()[c];
  }
  sum.Add(rays.light, ray_factor);
  sum.Add(diffraction, diffraction_factor);
  return sum.Values();
}

}  // namespace thunderhead::physics
