#include "reference/path_radiance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "glm/geometric.hpp"
#include "physics/water.h"
#include "reference/tracking.h"

namespace thunderhead::reference {
namespace {

constexpr double kNoEnd_m = std::numeric_limits<double>::infinity();

// Below this throughput paths continue by Russian roulette.
constexpr double kRouletteThroughput = 0.1;

// In thick clouds of high albedo the number of paths with more than n collisions falls only as 1 /
// sqrt(n): a few very long ones would take most of the time. At this many collisions, and each time
// that number quadruples, paths survive with probability 1/2, which balances work and variance over
// path lengths.
constexpr int kLongPath = 64;

// Sunlight whose contribution, relative to isotropic scattering, is below this is sampled by
// Russian roulette.
constexpr double kRouletteSunlight = 0.5;

// Share of paths from the eye that also follow light that the medium sends to the air.
constexpr double kAirPathShare = 0.25;

double Largest(const glm::dvec3& color) { return std::max({color.x, color.y, color.z}); }

// One path from the eye: the radiance so far, and its throughput.
class Path {
 public:
  Path(const Medium& medium, const Surroundings& surroundings, const Ray& ray, RandomStream* random,
       const PathOptions& options)
      : medium_(medium),
        surroundings_(surroundings),
        ray_(ray),
        random_(random),
        options_(options),
        hero_(static_cast<std::size_t>(3.0 * random->Uniform())) {}

  glm::dvec3 Follow() {
    while (Advance()) {
      if (!Survive()) break;
    }
    return radiance_;
  }

  bool MetMedium() const { return met_medium_; }

 private:
  // One free flight and the event at its end; false when the path ends.
  bool Advance() {
    const double ground_m = GroundDistance_m();
    const std::optional<double> collision_m =
        SampleCollision(medium_, ray_, ground_m, random_, optics_);
    if (collision_m.has_value()) {
      if (seen_from_eye_) met_medium_ = true;
      ShadeAir(*collision_m);
      PassAir(*collision_m, Behind::kMedium);
      return Scatter(ray_.At(*collision_m));
    }
    ShadeAir(ground_m);
    if (ground_m < kNoEnd_m) return Reflect(ground_m);
    const auto& sky =
        seen_from_eye_ && surroundings_.seen_sky ? surroundings_.seen_sky : surroundings_.sky;
    if (sky) radiance_ += Carried() * sky(ray_.direction);
    if (seen_from_eye_) SeeSun();
    return false;
  }

  void SeeSun() {
    if (!surroundings_.disc.has_value()) return;
    const SunDisc& disc = *surroundings_.disc;
    if (glm::dot(ray_.direction, surroundings_.towards_sun) >= disc.cosine) {
      radiance_ += Carried() * disc.radiance;
    }
  }

  double GroundDistance_m() const {
    if (!surroundings_.ground.has_value()) return kNoEnd_m;
    const Ground& ground = *surroundings_.ground;
    const glm::dvec2 across(ray_.direction);
    const double above_m = ray_.origin_m.z - GroundHeight_m(ray_.origin_m);
    const double closing =
        -ray_.direction.z -
        ground.curvature_per_m * glm::dot(glm::dvec2(ray_.origin_m) - ground.touch_m, across);
    const double discriminant =
        closing * closing - 2.0 * ground.curvature_per_m * glm::dot(across, across) * above_m;
    if (above_m <= 0.0 || closing <= 0.0 || discriminant < 0.0) return kNoEnd_m;
    return 2.0 * above_m / (closing + std::sqrt(discriminant));
  }

  double GroundHeight_m(const glm::dvec3& point_m) const {
    const Ground& ground = *surroundings_.ground;
    const glm::dvec2 off_m = glm::dvec2(point_m) - ground.touch_m;
    return ground.height_m - 0.5 * ground.curvature_per_m * glm::dot(off_m, off_m);
  }

  // Air matters only on the segment to the eye.
  void PassAir(double distance_m, Behind behind) {
    if (seen_from_eye_ && surroundings_.air) {
      const Air air = surroundings_.air(ray_, distance_m, behind);
      radiance_ += Carried() * air.airlight;
      throughput_ *= air.transmittance;
    }
    seen_from_eye_ = false;
  }

  // Takes the medium's shadow from the light of the air before `distance_m`, seen at one random
  // place. The light that air has scattered before comes there from a random direction of the upper
  // half: where that meets the medium, what comes is the medium's light in place of the sky's.
  void ShadeAir(double distance_m) {
    if (!seen_from_eye_ || !surroundings_.shaded_air.has_value()) return;
    const ShadedAir& air = *surroundings_.shaded_air;
    const Interval shaded = IntervalIn(air.boxes, distance_m);
    const double length_m = shaded.end_m - shaded.begin_m;
    if (length_m <= 0.0) return;
    const double at_m = shaded.begin_m + length_m * random_->Uniform();
    const AirLight light = air.light(ray_, at_m);
    const glm::dvec3 point_m = ray_.At(at_m);
    const glm::dvec3 weight = Carried() * length_m;
    const double of_sun = 1.0 - EstimateTransmittance(medium_, {point_m, surroundings_.towards_sun},
                                                      kNoEnd_m, random_);
    radiance_ -= weight * light.of_sun * of_sun;
    if (random_->Uniform() >= kAirPathShare) return;
    const Ray upward{point_m, SampleUpward(random_)};
    const std::optional<double> collision_m = SampleCollision(medium_, upward, kNoEnd_m, random_);
    if (!collision_m.has_value()) return;
    Path path(medium_, surroundings_, upward, random_, options_);
    const glm::dvec3 from_storm = path.FollowFrom(*collision_m);
    radiance_ -= weight / kAirPathShare * (light.of_sky - light.per_radiance * from_storm);
  }

  // The light of a path that does not come from an eye and meets the medium there.
  glm::dvec3 FollowFrom(double collision_m) {
    seen_from_eye_ = false;
    return Scatter(ray_.At(collision_m)) && Survive() ? Follow() : radiance_;
  }

  struct Interval {
    double begin_m = 0.0;
    double end_m = 0.0;
  };

  // The part of the ray up to `distance_m` from the first of the boxes to the last.
  Interval IntervalIn(const std::vector<Box>& boxes, double distance_m) const {
    Interval all{kNoEnd_m, 0.0};
    for (const Box& box : boxes) {
      Interval in{0.0, distance_m};
      for (int axis = 0; axis < 3; ++axis) {
        // A ray along a side divides by zero, and is then inside or outside for all its length.
        const double a = (box.low_m[axis] - ray_.origin_m[axis]) / ray_.direction[axis];
        const double b = (box.high_m[axis] - ray_.origin_m[axis]) / ray_.direction[axis];
        in.begin_m = std::max(in.begin_m, std::min(a, b));
        in.end_m = std::min(in.end_m, std::max(a, b));
      }
      if (in.begin_m >= in.end_m) continue;
      all.begin_m = std::min(all.begin_m, in.begin_m);
      all.end_m = std::max(all.end_m, in.end_m);
    }
    return all.begin_m < all.end_m ? all : Interval{};
  }

  bool Scatter(const glm::dvec3& point_m) {
    const Scattering scattering = medium_.ScatteringAt(point_m, random_->Uniform(), optics_);
    if (scattering.phase == nullptr) return false;
    if (options_.max_scatterings > 0 && collisions_ >= options_.max_scatterings) return false;
    throughput_ *= scattering.weight;
    if (!Survive() || !GoOnAtLength()) return false;
    // From here on all light counts as light of the similar medium, this collision's sunlight, too.
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

  // Next-event estimation of light that arrives directly at the collision.
  void ScatterLight(const SampledPhase& phase, const glm::dvec3& point_m,
                    const DirectionalLight& light) {
    const glm::dvec3 value = phase.Value(glm::dot(ray_.direction, light.towards));
    const double worth = std::min(Largest(Carried() * value) / kRouletteSunlight, 1.0);
    if (random_->Uniform() < worth) {
      AddLight(point_m, light, value * (0.25 * std::numbers::inv_pi / worth));
    }
  }

  // Colours whose phase functions differ share one path, sampled from the hero colour's. Its weight
  // for a colour is the path's density by that colour's functions over the mean of all three:
  // Wilkie et al. 2014, Hero Wavelength Spectral Sampling, eq. 8. It is at most 3, whereas the
  // product of each scattering's ratio would have no bound.
  double TurnBy(const PhaseSample& sample) {
    spectral_ *= sample.weight;
    spectral_ *= 3.0 / (spectral_.x + spectral_.y + spectral_.z);
    return sample.mu;
  }

  // Throughput of the rest of the path, by colour.
  glm::dvec3 Carried() const { return throughput_ * spectral_; }

  bool Reflect(double ground_m) {
    const Ground& ground = *surroundings_.ground;
    glm::dvec3 point_m = ray_.At(ground_m);
    point_m.z = GroundHeight_m(point_m);
    SeenGround here{ground.albedo};
    if (seen_from_eye_ && ground.seen) here = ground.seen(glm::dvec2(point_m));
    PassAir(ground_m, Behind::kGround);
    radiance_ += Carried() * ground.radiance;
    if (here.water > 0.0) {
      if (random_->Uniform() < here.water) return ReflectByWater(point_m);
    }
    return ReflectDiffusely(point_m, here.albedo);
  }

  bool ReflectDiffusely(const glm::dvec3& point_m, const glm::dvec3& albedo) {
    throughput_ *= albedo;
    if (Largest(Carried()) <= 0.0) return false;
    const double sine = std::max(surroundings_.towards_sun.z, 0.0);
    AddLight(point_m, {surroundings_.towards_sun, surroundings_.SunAt(point_m.z)},
             glm::dvec3(sine * std::numbers::inv_pi));
    ray_ = {point_m, SampleCosine({0.0, 0.0, 1.0}, random_)};
    return true;
  }

  // Half of the paths are reflected by the surface, half by what is below.
  bool ReflectByWater(const glm::dvec3& point_m) {
    throughput_ *= 2.0;
    if (random_->Uniform() < 0.5) {
      return ReflectDiffusely(point_m, glm::dvec3(physics::glsl::water_albedo()));
    }
    glm::dvec3 towards_eye = -ray_.direction;
    towards_eye.z = std::max(towards_eye.z, 1e-3);
    towards_eye = glm::normalize(towards_eye);
    AddLight(point_m, {surroundings_.towards_sun, surroundings_.SunAt(point_m.z)},
             glm::dvec3(physics::glsl::glint(glm::vec3(towards_eye),
                                             glm::vec3(surroundings_.towards_sun))));
    // A facet by the density of facets on level ground, exp(-tan^2 / kWaterSlopes).
    const double slope =
        std::sqrt(-physics::glsl::kWaterSlopes * std::log(1.0 - random_->Uniform()));
    const double azimuth_rad = 2.0 * std::numbers::pi * random_->Uniform();
    const glm::dvec3 facet = glm::normalize(
        glm::dvec3(slope * std::cos(azimuth_rad), slope * std::sin(azimuth_rad), 1.0));
    const double facing = glm::dot(facet, towards_eye);
    const glm::dvec3 reflected = 2.0 * facing * facet - towards_eye;
    if (facing <= 0.0 || reflected.z <= 0.0) return false;
    const auto cosine = [](const glm::dvec3& direction) { return static_cast<float>(direction.z); };
    // Walter et al. 2007, eq. 41.
    throughput_ *= physics::glsl::facet_reflectance(static_cast<float>(facing)) * facing *
                   physics::glsl::facets_unhidden(cosine(towards_eye)) *
                   physics::glsl::facets_unhidden(cosine(reflected)) / (towards_eye.z * facet.z);
    ray_ = {point_m, reflected};
    return true;
  }

  // `reflected` is the radiance towards the path for unit irradiance.
  void AddLight(const glm::dvec3& point_m, const DirectionalLight& light,
                const glm::dvec3& reflected) {
    const glm::dvec3 unshadowed = Carried() * reflected * light.irradiance;
    if (Largest(unshadowed) <= 0.0) return;
    const Ray ray{point_m, light.towards};
    radiance_ += unshadowed * EstimateTransmittance(medium_, ray, kNoEnd_m, random_, optics_);
  }

  bool GoOnAtLength() {
    if (++collisions_ < next_roulette_) return true;
    next_roulette_ *= 4;
    throughput_ *= 2.0;
    return random_->Uniform() < 0.5;
  }

  bool Survive() {
    const double carried = Largest(Carried());
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
  bool seen_from_eye_ = true;
  bool met_medium_ = false;
  Optics optics_ = Optics::kExact;
  int collisions_ = 0;
  int next_roulette_ = kLongPath;
  std::size_t hero_;  // the colour whose phase functions are sampled
  glm::dvec3 spectral_{
      1.0};  // the path's weight by colour, as the hero's phase functions are sampled
  glm::dvec3 radiance_{0.0};
  glm::dvec3 throughput_{1.0};
};

}  // namespace

PathEstimate EstimateRadiance(const Medium& medium, const Surroundings& surroundings,
                              const Ray& ray, RandomStream* random, const PathOptions& options) {
  Path path(medium, surroundings, ray, random, options);
  const glm::dvec3 radiance = path.Follow();
  return {radiance, path.MetMedium()};
}

}  // namespace thunderhead::reference
