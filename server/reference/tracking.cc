#include "reference/tracking.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glm/geometric.hpp"
#include "reference/roulette.h"

namespace thunderhead::reference {

std::optional<double> SampleCollision(const Medium& medium, const Ray& ray, double limit_m,
                                      RandomStream* random, Optics optics) {
  BrickWalk walk(medium, ray, limit_m, optics);
  // Remaining optical depth, by the majorant, to the next possible collision.
  double depth = random->Exponential();
  Stretch stretch;
  while (walk.Next(&stretch)) {
    double at_m = stretch.begin_m;
    for (;;) {
      const double ahead = (stretch.end_m - at_m) * stretch.majorant_per_m;
      if (depth >= ahead) {
        depth -= ahead;
        break;
      }
      at_m += depth / stretch.majorant_per_m;
      if (random->Uniform() * stretch.majorant_per_m <
          medium.Extinction_per_m(ray.At(at_m), optics)) {
        return at_m;
      }
      depth = random->Exponential();
    }
  }
  return std::nullopt;
}

double EstimateTransmittance(const Medium& medium, const Ray& ray, double limit_m,
                             RandomStream* random, Optics optics) {
  BrickWalk walk(medium, ray, limit_m, optics);
  const double end_depth = kRouletteDepth + random->Exponential();
  double depth = 0.0;
  Stretch stretch;
  while (walk.Next(&stretch)) {
    depth += (stretch.end_m - stretch.begin_m) *
             medium.MeanExtinction_per_m(stretch.brick, ray.At(stretch.begin_m),
                                         ray.At(stretch.end_m), optics);
    if (depth > end_depth) return 0.0;
  }
  return std::exp(-std::min(depth, 1.0 * kRouletteDepth));
}

glm::dvec3 Deflect(const glm::dvec3& direction, double mu, double azimuth_rad) {
  // Two vectors perpendicular to `direction` are computed. Adding the sign of direction.z to
  // direction.z keeps the divisor away from 0.
  const double sign = std::copysign(1.0, direction.z);
  const double a = -1.0 / (sign + direction.z);
  const double b = direction.x * direction.y * a;
  const glm::dvec3 across(1.0 + sign * direction.x * direction.x * a, sign * b,
                          -sign * direction.x);
  const glm::dvec3 other(b, sign + direction.y * direction.y * a, -direction.y);
  const double sine = std::sqrt(std::max((1.0 - mu) * (1.0 + mu), 0.0));
  return glm::normalize(mu * direction + (sine * std::cos(azimuth_rad)) * across +
                        (sine * std::sin(azimuth_rad)) * other);
}

glm::dvec3 SampleUpward(RandomStream* random) {
  const double sine = random->Uniform();
  return Deflect({0.0, 0.0, 1.0}, sine, 2.0 * std::numbers::pi * random->Uniform());
}

glm::dvec3 SampleCosine(const glm::dvec3& normal, RandomStream* random) {
  const double mu = std::sqrt(random->Uniform());
  return Deflect(normal, mu, 2.0 * std::numbers::pi * random->Uniform());
}

}  // namespace thunderhead::reference
