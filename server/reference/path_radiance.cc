#include "reference/path_radiance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "glm/geometric.hpp"
#include "reference/eye_segment.h"
#include "reference/roulette.h"
#include "reference/tracking.h"

namespace thunderhead::reference {
namespace {

glm::dvec3 Arriving(const Medium& medium, const ThroughMedium& light, RandomStream* random,
                    Optics optics = Optics::kExact) {
  if (LargestColor(light.radiance) <= 0.0) return glm::dvec3(0.0);
  return light.radiance * EstimateTransmittance(medium, light.ray, kEndless_m, random, optics);
}

// A path after its first segment, with the radiance that it has gathered and its throughput.
class Path {
 public:
  Path(const Medium& medium, const Surroundings& surroundings, RandomStream* random,
       const PathOptions& options, const glm::dvec3& throughput = glm::dvec3(1.0))
      : medium_(medium),
        surroundings_(surroundings),
        random_(random),
        options_(options),
        hero_(static_cast<std::size_t>(3.0 * random->Uniform())),
        throughput_(throughput) {}

  // Returns the light that arrives along `ray`.
  glm::dvec3 Follow(const Ray& ray) {
    ray_ = ray;
    while (Survive()) {
      if (!Advance()) break;
    }
    return radiance_;
  }

  // Returns the light that the medium scatters at `point_m` in the direction opposite to
  // `direction`.
  glm::dvec3 FollowFrom(const glm::dvec3& point_m, const glm::dvec3& direction) {
    ray_ = {point_m, direction};
    return Scatter(point_m) ? Follow(ray_) : radiance_;
  }

 private:
  // Samples one free flight and the event at its end. Returns false when the path ends.
  bool Advance() {
    const double ground_m = GroundDistance_m(surroundings_, ray_);
    const std::optional<double> collision_m =
        SampleCollision(medium_, ray_, ground_m, random_, optics_);
    if (collision_m.has_value()) return Scatter(ray_.At(*collision_m));
    if (ground_m < kEndless_m) return Reflect(ground_m);
    if (surroundings_.sky) radiance_ += Carried() * surroundings_.sky(ray_.direction);
    return false;
  }

  bool Scatter(const glm::dvec3& point_m) {
    const Scattering scattering = medium_.ScatteringAt(point_m, random_->Uniform(), optics_);
    if (scattering.phase == nullptr) return false;
    if (options_.max_scatterings > 0 && collisions_ >= options_.max_scatterings) return false;
    throughput_ *= scattering.weight;
    if (!Survive() || !GoOnAtLength()) return false;
    // From here on, all light counts as light of the similar medium. This includes the sunlight
    // that arrives at this collision.
    if (options_.similar_after > 0 && collisions_ >= options_.similar_after) {
      optics_ = Optics::kSimilar;
    }
    ScatterLight(*scattering.phase, point_m,
                 {surroundings_.towards_sun, surroundings_.SunAt(point_m.z)});
    for (const DirectionalLight& light : surroundings_.lights) {
      ScatterLight(*scattering.phase, point_m, light);
    }
    const double mu_turned = TurnBy(scattering.phase->Sample(random_->Uniform(), hero_));
    const double azimuth_rad = 2.0 * std::numbers::pi * random_->Uniform();
    ray_ = {point_m, Deflect(ray_.direction, mu_turned, azimuth_rad)};
    return true;
  }

  // Adds the light that arrives directly at the collision, by next-event estimation.
  void ScatterLight(const SampledPhase& phase, const glm::dvec3& point_m,
                    const DirectionalLight& light) {
    const glm::dvec3 value = phase.Value(glm::dot(ray_.direction, light.towards));
    const double worth = std::min(LargestColor(Carried() * value) / kRouletteSunlight, 1.0);
    if (random_->Uniform() < worth) {
      const glm::dvec3 scattered = value * (0.25 * std::numbers::inv_pi / worth);
      Add({{point_m, light.towards}, Carried() * scattered * light.irradiance});
    }
  }

  // Samples the new direction. Colours with different phase functions share one path. The direction
  // is sampled from the function of one randomly chosen colour, the hero colour. The path's weight
  // for a colour is the path's density by that colour's functions, divided by the mean density over
  // the three colours. The source is Wilkie et al. 2014, Hero Wavelength Spectral Sampling, eq. 8.
  // This weight is at most 3. The product of the ratios at each scattering would have no bound.
  double TurnBy(const PhaseSample& sample) {
    spectral_ *= sample.weight;
    spectral_ *= 3.0 / (spectral_.x + spectral_.y + spectral_.z);
    return sample.mu;
  }

  // Returns the throughput of the rest of the path, by colour.
  glm::dvec3 Carried() const { return throughput_ * spectral_; }

  bool Reflect(double ground_m) {
    const Ground& ground = *surroundings_.ground;
    glm::dvec3 point_m = ray_.At(ground_m);
    point_m.z = GroundHeight_m(ground, point_m);
    radiance_ += Carried() * ground.radiance;
    throughput_ *= ground.albedo;
    if (LargestColor(Carried()) <= 0.0) return false;
    const Bounce bounce = ReflectDiffusely(surroundings_, point_m, Carried(), random_);
    Add(bounce.sunlight);
    ray_ = bounce.onward;
    return true;
  }

  void Add(const ThroughMedium& light) { radiance_ += Arriving(medium_, light, random_, optics_); }

  bool GoOnAtLength() {
    if (++collisions_ < next_roulette_) return true;
    next_roulette_ *= 4;
    throughput_ *= 2.0;
    return random_->Uniform() < 0.5;
  }

  bool Survive() {
    const double carried = LargestColor(Carried());
    if (carried >= kRouletteThroughput) return true;
    if (random_->Uniform() * kRouletteThroughput >= carried) return false;
    throughput_ *= kRouletteThroughput / carried;
    return true;
  }

  const Medium& medium_;
  const Surroundings& surroundings_;
  Ray ray_;
  RandomStream* random_;
  const PathOptions& options_;
  Optics optics_ = Optics::kExact;
  int collisions_ = 0;
  int next_roulette_ = kLongPath;
  std::size_t hero_;  // index of the colour whose phase functions are sampled
  glm::dvec3 spectral_{
      1.0};  // the path's weight by colour, because the hero's phase functions are sampled
  glm::dvec3 radiance_{0.0};
  glm::dvec3 throughput_;
};

}  // namespace

PathEstimate EstimateRadiance(const Medium& medium, const Surroundings& surroundings,
                              const Ray& ray, RandomStream* random, const PathOptions& options) {
  const double ground_m = GroundDistance_m(surroundings, ray);
  const std::optional<double> collision_m = SampleCollision(medium, ray, ground_m, random);
  const EyeSegment segment = FollowFromEye(surroundings, ray, ground_m, collision_m, random);
  glm::dvec3 radiance = segment.radiance;
  for (const ThroughMedium& light : segment.shaded) radiance += Arriving(medium, light, random);
  if (segment.air.has_value()) {
    const AirFromMedium& air = *segment.air;
    const std::optional<double> met_m = SampleCollision(medium, air.ray, kEndless_m, random);
    if (met_m.has_value()) {
      Path path(medium, surroundings, random, options);
      radiance -=
          air.of_sky - air.per_radiance * path.FollowFrom(air.ray.At(*met_m), air.ray.direction);
    }
  }
  if (segment.then != EyeSegment::Then::kEnds) {
    const Ray& onward = segment.onward;
    Path path(medium, surroundings, random, options, segment.throughput);
    radiance += segment.then == EyeSegment::Then::kScatters
                    ? path.FollowFrom(onward.origin_m, onward.direction)
                    : path.Follow(onward);
  }
  return {radiance, collision_m.has_value()};
}

}  // namespace thunderhead::reference
