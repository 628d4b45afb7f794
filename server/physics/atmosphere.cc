#include "physics/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/geometric.hpp"
#include "physics/sky.h"

namespace thunderhead::physics {
namespace {

// Single-scattering albedo of continental haze.
constexpr float kHazeAlbedo = 0.95F;

// Of 300 Dobson units at 650, 550 and 450 nm, in a layer around 25 km (Chappuis bands).
const glm::vec3 kOzoneDepth(0.020F, 0.027F, 0.0014F);
constexpr float kOzoneMiddle_m = 2.5e4F;
constexpr float kOzoneHalfWidth_m = 1.5e4F;

const glm::vec2 kScaleHeights_m(glsl::kAirScaleHeight_m, glsl::kHazeScaleHeight_m);

// Half the angle that the sun's disc fills.
constexpr float kSunRadius = 0.00465F;

constexpr float kInverseFourPi = 0.25F * std::numbers::inv_pi_v<float>;

// Densities of air, haze and ozone, over those at their densest.
glm::vec3 Densities(float height_m) {
  const float ozone = 1.0F - std::abs(height_m - kOzoneMiddle_m) / kOzoneHalfWidth_m;
  return {std::exp(-height_m / glsl::kAirScaleHeight_m),
          std::exp(-height_m / glsl::kHazeScaleHeight_m), std::max(ozone, 0.0F)};
}

// Height at `distance_m` along a ray. In floats the radii's difference would lose metres.
float HeightAlong(float height_m, float sine, float distance_m) {
  const double radius = static_cast<double>(kEarthRadius_m) + height_m;
  const double d = distance_m;
  return static_cast<float>(std::sqrt(radius * radius + d * d + 2.0 * radius * sine * d) -
                            kEarthRadius_m);
}

// Along a ray to a sphere of the given height around the Earth, from below it; and from above it.
float DistanceUpTo_m(float target_m, float height_m, float sine) {
  const double radius = static_cast<double>(kEarthRadius_m) + height_m;
  const double target = static_cast<double>(kEarthRadius_m) + target_m;
  const double across = radius * sine;
  return static_cast<float>(
      -across + std::sqrt(std::max(across * across - radius * radius + target * target, 0.0)));
}

float DistanceDownTo_m(float target_m, float height_m, float sine) {
  const double radius = static_cast<double>(kEarthRadius_m) + height_m;
  const double target = static_cast<double>(kEarthRadius_m) + target_m;
  const double across = radius * sine;
  const double inside = across * across - radius * radius + target * target;
  return static_cast<float>(-across - std::sqrt(std::max(inside, 0.0)));
}

// Air, haze and ozone from a point to space, in metres of their densest. The same for every
// turbidity: a table by height and, from the horizon up, sine of elevation, both by square roots.
class WaysToSpace {
 public:
  static const WaysToSpace& Get() {
    static const WaysToSpace ways;
    return ways;
  }

  glm::vec3 From(const AirPlace& place) const {
    const float horizon = HorizonSine(place.height_m);
    const float up =
        std::sqrt(glm::clamp((place.sun_sine - horizon) / (1.0F - horizon), 0.0F, 1.0F));
    const float high = std::sqrt(glm::clamp(place.height_m / kAtmosphereTop_m, 0.0F, 1.0F));
    const glm::vec2 cell(up * (kSines - 1), high * (kHeights - 1));
    const glm::ivec2 low = glm::min(glm::ivec2(cell), glm::ivec2(kSines - 2, kHeights - 2));
    const glm::vec2 share = cell - glm::vec2(low);
    const auto at = [this](int x, int y) {
      return ways_m_[static_cast<std::size_t>(y * kSines + x)];
    };
    return glm::mix(glm::mix(at(low.x, low.y), at(low.x + 1, low.y), share.x),
                    glm::mix(at(low.x, low.y + 1), at(low.x + 1, low.y + 1), share.x), share.y);
  }

 private:
  static constexpr int kSines = 64;
  static constexpr int kHeights = 32;

  WaysToSpace() {
    for (int y = 0; y < kHeights; ++y) {
      const float high = static_cast<float>(y) / (kHeights - 1);
      const float height_m = high * high * kAtmosphereTop_m;
      const float horizon = HorizonSine(height_m);
      for (int x = 0; x < kSines; ++x) {
        const float up = static_cast<float>(x) / (kSines - 1);
        ways_m_.push_back(Integrate(height_m, horizon + up * up * (1.0F - horizon)));
      }
    }
  }

  static glm::vec3 Integrate(float height_m, float sine) {
    constexpr int kSteps = 200;
    const float end_m = DistanceUpTo_m(kAtmosphereTop_m, height_m, sine);
    glm::vec3 way_m(0.0F);
    for (int i = 0; i < kSteps; ++i) {
      const float at_m = end_m * (static_cast<float>(i) + 0.5F) / kSteps;
      way_m += Densities(HeightAlong(height_m, sine, at_m)) * (end_m / kSteps);
    }
    return way_m;
  }

  std::vector<glm::vec3> ways_m_;
};

constexpr int kDiffuseHeights = 10;
constexpr int kDiffuseSines = 24;
constexpr float kLowestSine = -0.4F;  // below, no part of the atmosphere that matters is lit

}  // namespace

float HorizonSine(float height_m, float ground_m) {
  const float ratio = (kEarthRadius_m + ground_m) / (kEarthRadius_m + std::max(height_m, ground_m));
  return -std::sqrt(std::max(1.0F - ratio * ratio, 0.0F));
}

Atmosphere::Atmosphere(float turbidity, float ground_albedo)
    : haze_depth_(glsl::haze_optical_depth(turbidity)) {
  diffuse_.reserve(kDiffuseHeights * kDiffuseSines);
  for (int y = 0; y < kDiffuseHeights; ++y) {
    const float high = static_cast<float>(y) / (kDiffuseHeights - 1);
    for (int x = 0; x < kDiffuseSines; ++x) {
      const float sine =
          kLowestSine + (1.0F - kLowestSine) * static_cast<float>(x) / (kDiffuseSines - 1);
      diffuse_.push_back(SumOrders({high * high * kAtmosphereTop_m, sine}, ground_albedo));
    }
  }
}

AirOptics Atmosphere::At(float height_m) const {
  const glm::vec3 density = Densities(height_m);
  AirOptics optics;
  optics.air = glsl::air_optical_depth() * (density.x / glsl::kAirScaleHeight_m);
  const glm::vec3 haze = haze_depth_ * (density.y / glsl::kHazeScaleHeight_m);
  optics.haze = haze * kHazeAlbedo;
  optics.extinction = optics.air + haze + kOzoneDepth * (density.z / kOzoneHalfWidth_m);
  return optics;
}

glm::vec3 Atmosphere::SunTransmittance(const AirPlace& place) const {
  const float above = (place.sun_sine - HorizonSine(place.height_m)) / kSunRadius;
  if (above <= -1.0F) return glm::vec3(0.0F);
  const glm::vec3 way_m = WaysToSpace::Get().From(place);
  const glm::vec3 depth = glsl::air_optical_depth() * (way_m.x / glsl::kAirScaleHeight_m) +
                          haze_depth_ * (way_m.y / glsl::kHazeScaleHeight_m) +
                          kOzoneDepth * (way_m.z / kOzoneHalfWidth_m);
  return glm::exp(-depth) * std::min(0.5F + 0.5F * above, 1.0F);
}

glm::vec3 Atmosphere::DiffuseMeanRadiance(const AirPlace& place) const {
  if (place.sun_sine <= kLowestSine) return glm::vec3(0.0F);
  const float high = std::sqrt(glm::clamp(place.height_m / kAtmosphereTop_m, 0.0F, 1.0F));
  const glm::vec2 cell((place.sun_sine - kLowestSine) / (1.0F - kLowestSine) * (kDiffuseSines - 1),
                       high * (kDiffuseHeights - 1));
  const glm::ivec2 low =
      glm::min(glm::ivec2(cell), glm::ivec2(kDiffuseSines - 2, kDiffuseHeights - 2));
  const glm::vec2 share = cell - glm::vec2(low);
  const auto at = [this](int x, int y) {
    return diffuse_[static_cast<std::size_t>(y * kDiffuseSines + x)];
  };
  return glm::mix(glm::mix(at(low.x, low.y), at(low.x + 1, low.y), share.x),
                  glm::mix(at(low.x, low.y + 1), at(low.x + 1, low.y + 1), share.x), share.y);
}

Atmosphere::Gathered Atmosphere::Gather(const Ray& ray, bool with_diffuse) const {
  const float sine = ray.direction.z;
  Gathered gathered;
  gathered.meets_ground = sine < HorizonSine(ray.height_m, ray.ground_m);
  const float end_m = gathered.meets_ground ? DistanceDownTo_m(ray.ground_m, ray.height_m, sine)
                                            : DistanceUpTo_m(kAtmosphereTop_m, ray.height_m, sine);
  const auto place_at = [&](float distance_m) {
    const float height_m = std::max(HeightAlong(ray.height_m, sine, distance_m), 0.0F);
    // The upright there, from the Earth's middle.
    const glm::vec3 from_middle =
        distance_m * ray.direction + glm::vec3(0.0F, 0.0F, kEarthRadius_m + ray.height_m);
    return AirPlace{height_m, glm::dot(from_middle, ray.towards_sun) / (kEarthRadius_m + height_m)};
  };
  float from_m = 0.0F;
  for (int i = 1; i <= ray.steps; ++i) {
    // Steps grow with the distance, as the air thins out with it.
    const float share = static_cast<float>(i) / static_cast<float>(ray.steps);
    const float to_m = end_m * share * share;
    const AirPlace place = place_at(0.5F * (from_m + to_m));
    const AirOptics optics = At(place.height_m);
    const glm::vec3 passed = glm::exp(-optics.extinction * (to_m - from_m));
    // The step's light on its way through the step itself.
    const glm::vec3 seen =
        gathered.passed * (1.0F - passed) / glm::max(optics.extinction, glm::vec3(1e-20F));
    const glm::vec3 sunlit = seen * SunTransmittance(place);
    gathered.air += sunlit * optics.air;
    gathered.haze += sunlit * optics.haze;
    const glm::vec3 scattering = optics.air + optics.haze;
    if (with_diffuse) gathered.diffuse += seen * scattering * DiffuseMeanRadiance(place);
    gathered.uniform += seen * scattering;
    gathered.passed *= passed;
    gathered.way += glsl::densities_of_air(place.height_m) * ((to_m - from_m) / kScaleHeights_m);
    from_m = to_m;
  }
  gathered.end = place_at(end_m);
  return gathered;
}

glm::vec3 Atmosphere::SumOrders(const AirPlace& place, float ground_albedo) const {
  constexpr int kDirections = 40;
  const float across = std::sqrt(std::max(1.0F - place.sun_sine * place.sun_sine, 0.0F));
  glm::vec3 second(0.0F);
  glm::vec3 again(0.0F);  // share of uniform light that comes back after one more scattering
  for (int i = 0; i < kDirections; ++i) {
    // A spiral of points, evenly over the sphere.
    const float sine = 1.0F - 2.0F * (static_cast<float>(i) + 0.5F) / kDirections;
    const float cosine = std::sqrt(1.0F - sine * sine);
    const float azimuth = static_cast<float>(i) * 2.39996323F;
    Ray ray;
    ray.height_m = place.height_m;
    ray.direction = {cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine};
    ray.towards_sun = {across, 0.0F, place.sun_sine};
    ray.steps = 12;
    const Gathered gathered = Gather(ray, false);
    second += (gathered.air + gathered.haze) * kInverseFourPi;
    again += gathered.uniform;
    if (gathered.meets_ground) {
      const float lit = std::max(gathered.end.sun_sine, 0.0F) * std::numbers::inv_pi_v<float>;
      second += gathered.passed * SunTransmittance(gathered.end) * (ground_albedo * lit);
      again += gathered.passed * ground_albedo;
    }
  }
  return second / (static_cast<float>(kDirections) - again);
}

}  // namespace thunderhead::physics
