#include "physics/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "glm/common.hpp"
#include "glm/exponential.hpp"
#include "glm/geometric.hpp"
#include "physics/sky.h"

namespace thunderhead::physics {
namespace {

// Vertical optical depth of 300 Dobson units of ozone at 650, 550 and 450 nm (Chappuis bands). The
// ozone is in a layer around a height of 25 km.
const glm::vec3 kOzoneDepth(0.020F, 0.027F, 0.0014F);
constexpr float kOzoneMiddle_m = 2.5e4F;
constexpr float kOzoneHalfWidth_m = 1.5e4F;

const glm::vec2 kScaleHeights_m(glsl::kAirScaleHeight_m, glsl::kHazeScaleHeight_m);

constexpr float kInverseFourPi = 0.25F * std::numbers::inv_pi_v<float>;

// Returns the densities of air, haze and ozone relative to their maxima.
glm::vec3 Densities(float height_m) {
  const float ozone = 1.0F - std::abs(height_m - kOzoneMiddle_m) / kOzoneHalfWidth_m;
  return {std::exp(-height_m / glsl::kAirScaleHeight_m),
          std::exp(-height_m / glsl::kHazeScaleHeight_m), std::max(ozone, 0.0F)};
}

// Returns the height at `distance_m` along a ray. It uses double precision, because in single
// precision the difference of two radii would be wrong by metres.
float HeightAlong(float height_m, float sine, float distance_m) {
  const double radius = static_cast<double>(kEarthRadius_m) + height_m;
  const double d = distance_m;
  return static_cast<float>(std::sqrt(radius * radius + d * d + 2.0 * radius * sine * d) -
                            kEarthRadius_m);
}

// Return the distance along a ray to the sphere at height `target_m` above sea level. The ray
// starts inside the sphere for DistanceUpTo_m and outside it for DistanceDownTo_m.
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

// Returns the position of a height in a table. The rows of the table are spaced evenly in the
// square root of the height, up to the atmosphere's top.
TableRow RowAt(float height_m, int rows) {
  const float high = std::sqrt(glm::clamp(height_m / kAtmosphereTop_m, 0.0F, 1.0F));
  const float place = high * static_cast<float>(rows - 1);
  const int low = std::min(static_cast<int>(place), rows - 2);
  return {low, place - static_cast<float>(low)};
}

// Interpolates bilinearly in a table of `columns` columns, at a fractional column and between two
// rows.
glm::vec3 Between(const std::vector<glm::vec3>& table, int columns, float column,
                  const TableRow& row) {
  const int left = std::min(static_cast<int>(column), columns - 2);
  const float share = column - static_cast<float>(left);
  const glm::vec3* low = table.data() + row.low * columns + left;
  const glm::vec3* high = low + columns;
  return glm::mix(glm::mix(low[0], low[1], share), glm::mix(high[0], high[1], share), row.share);
}

// Table of the amounts of air, haze and ozone from a point to space, in metres at their maximum
// densities. The amounts do not depend on turbidity, so one table serves all atmospheres. Its axes
// are the height, and the sine of the elevation from the horizon upwards. Both axes are spaced
// evenly in the square root of the value.
class ColumnsToSpace {
 public:
  static const ColumnsToSpace& Get() {
    static const ColumnsToSpace columns;
    return columns;
  }

  static TableRow RowAt(float height_m) { return physics::RowAt(height_m, kHeights); }

  glm::vec3 From(const AirLevel& level, float sun_sine) const {
    const float horizon = level.horizon_sine;
    const float up = std::sqrt(glm::clamp((sun_sine - horizon) / (1.0F - horizon), 0.0F, 1.0F));
    return Between(columns_m_, kSines, up * (kSines - 1), level.columns);
  }

 private:
  static constexpr int kSines = 64;
  static constexpr int kHeights = 32;

  ColumnsToSpace() {
    for (int y = 0; y < kHeights; ++y) {
      const float high = static_cast<float>(y) / (kHeights - 1);
      const float height_m = high * high * kAtmosphereTop_m;
      const float horizon = HorizonSine(height_m);
      for (int x = 0; x < kSines; ++x) {
        const float up = static_cast<float>(x) / (kSines - 1);
        columns_m_.push_back(Integrate(height_m, horizon + up * up * (1.0F - horizon)));
      }
    }
  }

  static glm::vec3 Integrate(float height_m, float sine) {
    constexpr int kSteps = 200;
    const float end_m = DistanceUpTo_m(kAtmosphereTop_m, height_m, sine);
    glm::vec3 column_m(0.0F);
    for (int i = 0; i < kSteps; ++i) {
      const float at_m = end_m * (static_cast<float>(i) + 0.5F) / kSteps;
      column_m += Densities(HeightAlong(height_m, sine, at_m)) * (end_m / kSteps);
    }
    return column_m;
  }

  std::vector<glm::vec3> columns_m_;
};

constexpr int kDiffuseHeights = 10;
constexpr int kDiffuseSines = 24;
// Lowest sine of the sun's elevation in the table. For lower suns the atmosphere is dark.
constexpr float kLowestSine = -0.4F;

AirLevel LevelAt(float height_m) {
  return {HorizonSine(height_m), ColumnsToSpace::RowAt(height_m), RowAt(height_m, kDiffuseHeights)};
}

}  // namespace

float HorizonSine(float height_m, float ground_m) {
  const float ratio = (kEarthRadius_m + ground_m) / (kEarthRadius_m + std::max(height_m, ground_m));
  return -std::sqrt(std::max(1.0F - ratio * ratio, 0.0F));
}

Atmosphere::Atmosphere(float turbidity, float ground_albedo)
    : haze_depth_(glsl::haze_optical_depth(turbidity)) {
  std::vector<glm::vec3> diffuse;
  diffuse.reserve(kDiffuseHeights * kDiffuseSines);
  for (int y = 0; y < kDiffuseHeights; ++y) {
    const float high = static_cast<float>(y) / (kDiffuseHeights - 1);
    for (int x = 0; x < kDiffuseSines; ++x) {
      const float sine =
          kLowestSine + (1.0F - kLowestSine) * static_cast<float>(x) / (kDiffuseSines - 1);
      diffuse.push_back(SumOrders({high * high * kAtmosphereTop_m, sine}, ground_albedo));
    }
  }
  diffuse_ = std::move(diffuse);
}

AirOptics Atmosphere::At(float height_m) const {
  const glm::vec3 density = Densities(height_m);
  AirOptics optics;
  optics.air = glsl::air_scattering_per_m(glm::vec2(density));
  const glm::vec3 haze = haze_depth_ * (density.y / glsl::kHazeScaleHeight_m);
  optics.haze = haze * glsl::kHazeAlbedo;
  optics.extinction = optics.air + haze + kOzoneDepth * (density.z / kOzoneHalfWidth_m);
  return optics;
}

glm::vec3 Atmosphere::SunTransmittance(const AirPlace& place) const {
  return SunTransmittance(LevelAt(place.height_m), place.sun_sine);
}

glm::vec3 Atmosphere::SunTransmittance(const AirLevel& level, float sun_sine) const {
  const float above = (sun_sine - level.horizon_sine) / static_cast<float>(kSunRadius_rad);
  if (above <= -1.0F) return glm::vec3(0.0F);
  const glm::vec3 column_m = ColumnsToSpace::Get().From(level, sun_sine);
  const glm::vec3 depth = glsl::air_optical_depth() * (column_m.x / glsl::kAirScaleHeight_m) +
                          haze_depth_ * (column_m.y / glsl::kHazeScaleHeight_m) +
                          kOzoneDepth * (column_m.z / kOzoneHalfWidth_m);
  return glm::exp(-depth) * std::min(0.5F + 0.5F * above, 1.0F);
}

glm::vec3 Atmosphere::DiffuseMeanRadiance(const AirPlace& place) const {
  return DiffuseMeanRadiance(RowAt(place.height_m, kDiffuseHeights), place.sun_sine);
}

glm::vec3 Atmosphere::DiffuseMeanRadiance(const TableRow& row, float sun_sine) const {
  if (sun_sine <= kLowestSine) return glm::vec3(0.0F);
  return Between(diffuse_, kDiffuseSines,
                 (sun_sine - kLowestSine) / (1.0F - kLowestSine) * (kDiffuseSines - 1), row);
}

Atmosphere::Line Atmosphere::Along(const Ray& ray) const {
  Line line;
  line.height_m = ray.height_m;
  line.meets_ground = ray.sine < HorizonSine(ray.height_m, ray.ground_m);
  line.end_m = line.meets_ground ? DistanceDownTo_m(ray.ground_m, ray.height_m, ray.sine)
                                 : DistanceUpTo_m(kAtmosphereTop_m, ray.height_m, ray.sine);
  const auto height_at = [&](float distance_m) {
    return std::max(HeightAlong(ray.height_m, ray.sine, distance_m), 0.0F);
  };
  line.end_height_m = height_at(line.end_m);
  if (line.end_m <= 0.0F) return line;
  float from_m = 0.0F;
  for (int i = 1; i <= ray.steps; ++i) {
    // Steps grow with distance from the start, because the air usually gets thinner.
    const float share = static_cast<float>(i) / static_cast<float>(ray.steps);
    const float to_m = line.end_m * share * share;
    const float middle_m = 0.5F * (from_m + to_m);
    const float height_m = height_at(middle_m);
    const AirOptics optics = At(height_m);
    const glm::vec3 transmittance = glm::exp(-optics.extinction * (to_m - from_m));
    // The light that is scattered within the step is also attenuated by the step itself.
    const glm::vec3 seen = line.transmittance * (1.0F - transmittance) /
                           glm::max(optics.extinction, glm::vec3(1e-20F));
    line.steps.push_back(
        {middle_m, height_m, seen * optics.air, seen * optics.haze, LevelAt(height_m)});
    line.transmittance *= transmittance;
    line.air_mass += glsl::densities_of_air(height_m) * ((to_m - from_m) / kScaleHeights_m);
    from_m = to_m;
  }
  return line;
}

namespace {

// Returns a point of a ray with the sun's elevation there. The vertical at the point tilts with the
// distance, because the Earth is round.
AirPlace PlaceOn(const Atmosphere::Line& line, const Atmosphere::Sunwards& sun, float distance_m,
                 float height_m) {
  const float above = distance_m * sun.mu + (kEarthRadius_m + line.height_m) * sun.sine;
  return {height_m, above / (kEarthRadius_m + height_m)};
}

}  // namespace

Atmosphere::Gathered Atmosphere::Gather(const Line& line, const Sunwards& sun) const {
  Gathered gathered;
  for (const Line::Step& step : line.steps) {
    const float sun_sine = PlaceOn(line, sun, step.distance_m, step.height_m).sun_sine;
    const glm::vec3 sunlight = SunTransmittance(step.level, sun_sine);
    gathered.air += sunlight * step.air;
    gathered.haze += sunlight * step.haze;
    // While the constructor computes the higher orders, diffuse_ is still empty.
    if (!diffuse_.empty()) {
      gathered.diffuse +=
          (step.air + step.haze) * DiffuseMeanRadiance(step.level.diffuse, sun_sine);
    }
  }
  return gathered;
}

glm::vec3 Atmosphere::SumOrders(const AirPlace& place, float ground_albedo) const {
  constexpr int kDirections = 40;
  const float across = std::sqrt(std::max(1.0F - place.sun_sine * place.sun_sine, 0.0F));
  glm::vec3 second(0.0F);
  // If light of radiance 1 arrived everywhere from all directions, this sum divided by kDirections
  // would be the mean radiance that the point receives after one more scattering or reflection.
  glm::vec3 again(0.0F);
  for (int i = 0; i < kDirections; ++i) {
    // A Fibonacci spiral spreads the directions evenly over the sphere.
    const float sine = 1.0F - 2.0F * (static_cast<float>(i) + 0.5F) / kDirections;
    const float cosine = std::sqrt(1.0F - sine * sine);
    const float azimuth = static_cast<float>(i) * 2.39996323F;
    const Line line = Along({.height_m = place.height_m, .sine = sine, .steps = 12});
    const Sunwards sun{place.sun_sine, cosine * std::cos(azimuth) * across + sine * place.sun_sine};
    const Gathered gathered = Gather(line, sun);
    second += (gathered.air + gathered.haze) * kInverseFourPi;
    for (const Line::Step& step : line.steps) again += step.air + step.haze;
    if (line.meets_ground) {
      const AirPlace end = PlaceOn(line, sun, line.end_m, line.end_height_m);
      const float lit = std::max(end.sun_sine, 0.0F) * std::numbers::inv_pi_v<float>;
      second += line.transmittance * SunTransmittance(end) * (ground_albedo * lit);
      again += line.transmittance * ground_albedo;
    }
  }
  return second / (static_cast<float>(kDirections) - again);
}

}  // namespace thunderhead::physics
