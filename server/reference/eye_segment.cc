#include "reference/eye_segment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glm/geometric.hpp"
#include "physics/water.h"
#include "reference/tracking.h"

namespace thunderhead::reference {
namespace {

// Share of the paths that also trace a ray for AirFromMedium (the medium's light that the air
// scatters to the eye).
constexpr double kAirPathShare = 0.25;

// Returns the part of `ray` up to `distance_m` that begins where the ray enters the first of the
// boxes and ends where it leaves the last. It is empty if end <= begin.
RayInterval IntervalIn(const std::vector<Box>& boxes, const Ray& ray, double distance_m) {
  RayInterval all{kEndless_m, 0.0};
  for (const Box& box : boxes) {
    RayInterval in{0.0, distance_m};
    for (int axis = 0; axis < 3; ++axis) {
      // If the ray is parallel to a side, this divides by zero. The infinite results then put the
      // whole ray inside or outside.
      const double a = (box.low_m[axis] - ray.origin_m[axis]) / ray.direction[axis];
      const double b = (box.high_m[axis] - ray.origin_m[axis]) / ray.direction[axis];
      in.begin_m = std::max(in.begin_m, std::min(a, b));
      in.end_m = std::min(in.end_m, std::max(a, b));
    }
    if (in.begin_m >= in.end_m) continue;
    all.begin_m = std::min(all.begin_m, in.begin_m);
    all.end_m = std::max(all.end_m, in.end_m);
  }
  return all;
}

class Segment {
 public:
  Segment(const Surroundings& surroundings, const Ray& ray, RandomStream* random)
      : surroundings_(surroundings), ray_(ray), random_(random) {}

  // Subtracts the medium's shadow from the light of the air that is nearer than `distance_m`. The
  // shadow is estimated at one random place on the ray. The skylight there arrives from a random
  // direction of the upper hemisphere. If that direction meets the medium, the medium's light
  // replaces the skylight.
  void ShadeAir(double distance_m) {
    if (!surroundings_.shaded_air.has_value()) return;
    const ShadedAir& air = *surroundings_.shaded_air;
    const RayInterval shaded = IntervalIn(air.boxes, ray_, distance_m);
    const double length_m = shaded.end_m - shaded.begin_m;
    if (length_m <= 0.0) return;
    const double at_m = shaded.begin_m + length_m * random_->Uniform();
    const AirLight light = air.light(ray_, at_m);
    const glm::dvec3 point_m = ray_.At(at_m);
    const glm::dvec3 of_sun = length_m * light.of_sun;
    segment_.radiance -= of_sun;
    segment_.shaded.push_back({{point_m, surroundings_.towards_sun}, of_sun});
    if (random_->Uniform() >= kAirPathShare) return;
    const double weight_m = length_m / kAirPathShare;
    segment_.air = AirFromMedium{
        {point_m, SampleUpward(random_)}, weight_m * light.of_sky, weight_m * light.per_radiance};
  }

  EyeSegment Scatters(double collision_m) {
    PassAir(collision_m, Behind::kMedium);
    GoOn(EyeSegment::Then::kScatters, {ray_.At(collision_m), ray_.direction});
    return segment_;
  }

  EyeSegment Leaves() {
    const auto& sky = surroundings_.seen_sky ? surroundings_.seen_sky : surroundings_.sky;
    if (sky) segment_.radiance += sky(ray_.direction);
    if (surroundings_.disc.has_value()) {
      const SunDisc& disc = *surroundings_.disc;
      if (glm::dot(ray_.direction, surroundings_.towards_sun) >= disc.cosine) {
        segment_.radiance += disc.radiance;
      }
    }
    return segment_;
  }

  EyeSegment Reflects(double ground_m) {
    const Ground& ground = *surroundings_.ground;
    glm::dvec3 point_m = ray_.At(ground_m);
    point_m.z = GroundHeight_m(ground, point_m);
    const SeenGround here =
        ground.seen ? ground.seen(glm::dvec2(point_m)) : SeenGround{ground.albedo};
    PassAir(ground_m, Behind::kGround);
    segment_.radiance += segment_.throughput * ground.radiance;
    if (here.water > 0.0 && random_->Uniform() < here.water) {
      ReflectByWater(point_m);
    } else {
      Reflect(point_m, here.albedo);
    }
    return segment_;
  }

 private:
  void PassAir(double distance_m, Behind behind) {
    if (!surroundings_.air) return;
    const Air air = surroundings_.air(ray_, distance_m, behind);
    segment_.radiance += air.airlight;
    segment_.throughput *= air.transmittance;
  }

  void GoOn(EyeSegment::Then then, const Ray& onward) {
    segment_.then = then;
    segment_.onward = onward;
  }

  void Reflect(const glm::dvec3& point_m, const glm::dvec3& albedo) {
    segment_.throughput *= albedo;
    if (LargestColor(segment_.throughput) <= 0.0) return;
    const Bounce bounce = ReflectDiffusely(surroundings_, point_m, segment_.throughput, random_);
    segment_.shaded.push_back(bounce.sunlight);
    GoOn(EyeSegment::Then::kFlies, bounce.onward);
  }

  // Half of the paths are reflected by the surface, and half by the water below it. The throughput
  // is doubled to compensate.
  void ReflectByWater(const glm::dvec3& point_m) {
    segment_.throughput *= 2.0;
    if (random_->Uniform() < 0.5) {
      return Reflect(point_m, glm::dvec3(physics::glsl::water_albedo()));
    }
    glm::dvec3 towards_eye = -ray_.direction;
    towards_eye.z = std::max(towards_eye.z, 1e-3);
    towards_eye = glm::normalize(towards_eye);
    const glm::dvec3 glint(
        physics::glsl::glint(glm::vec3(towards_eye), glm::vec3(surroundings_.towards_sun)));
    segment_.shaded.push_back({{point_m, surroundings_.towards_sun},
                               segment_.throughput * glint * surroundings_.SunAt(point_m.z)});
    // The facet of the rough water is sampled by the density of facets on level ground, exp(-tan^2
    // / kWaterSlopes).
    const double slope =
        std::sqrt(-physics::glsl::kWaterSlopes * std::log(1.0 - random_->Uniform()));
    const double azimuth_rad = 2.0 * std::numbers::pi * random_->Uniform();
    const glm::dvec3 facet = glm::normalize(
        glm::dvec3(slope * std::cos(azimuth_rad), slope * std::sin(azimuth_rad), 1.0));
    const double facing = glm::dot(facet, towards_eye);
    const glm::dvec3 reflected = 2.0 * facing * facet - towards_eye;
    if (facing <= 0.0 || reflected.z <= 0.0) return;
    const auto cosine = [](const glm::dvec3& direction) { return static_cast<float>(direction.z); };
    // Weight of the sampled facet: Walter et al. 2007, eq. 41.
    segment_.throughput *= physics::glsl::facet_reflectance(static_cast<float>(facing)) * facing *
                           physics::glsl::facets_unhidden(cosine(towards_eye)) *
                           physics::glsl::facets_unhidden(cosine(reflected)) /
                           (towards_eye.z * facet.z);
    GoOn(EyeSegment::Then::kFlies, {point_m, reflected});
  }

  const Surroundings& surroundings_;
  const Ray ray_;
  RandomStream* random_;
  EyeSegment segment_;
};

}  // namespace

double LargestColor(const glm::dvec3& color) { return std::max({color.x, color.y, color.z}); }

Bounce ReflectDiffusely(const Surroundings& surroundings, const glm::dvec3& point_m,
                        const glm::dvec3& carried, RandomStream* random) {
  const double sine = std::max(surroundings.towards_sun.z, 0.0);
  return {{{point_m, surroundings.towards_sun},
           carried * surroundings.SunAt(point_m.z) * (sine * std::numbers::inv_pi)},
          {point_m, SampleCosine({0.0, 0.0, 1.0}, random)}};
}

double GroundHeight_m(const Ground& ground, const glm::dvec3& point_m) {
  const glm::dvec2 off_m = glm::dvec2(point_m) - ground.touch_m;
  return ground.height_m - 0.5 * ground.curvature_per_m * glm::dot(off_m, off_m);
}

double GroundDistance_m(const Surroundings& surroundings, const Ray& ray) {
  if (!surroundings.ground.has_value()) return kEndless_m;
  const Ground& ground = *surroundings.ground;
  const glm::dvec2 across(ray.direction);
  const double above_m = ray.origin_m.z - GroundHeight_m(ground, ray.origin_m);
  const double closing =
      -ray.direction.z -
      ground.curvature_per_m * glm::dot(glm::dvec2(ray.origin_m) - ground.touch_m, across);
  const double discriminant =
      closing * closing - 2.0 * ground.curvature_per_m * glm::dot(across, across) * above_m;
  if (above_m <= 0.0 || closing <= 0.0 || discriminant < 0.0) return kEndless_m;
  return 2.0 * above_m / (closing + std::sqrt(discriminant));
}

EyeSegment FollowFromEye(const Surroundings& surroundings, const Ray& ray, double ground_m,
                         const std::optional<double>& collision_m, RandomStream* random) {
  Segment segment(surroundings, ray, random);
  segment.ShadeAir(collision_m.value_or(ground_m));
  if (collision_m.has_value()) return segment.Scatters(*collision_m);
  return ground_m < kEndless_m ? segment.Reflects(ground_m) : segment.Leaves();
}

}  // namespace thunderhead::reference
