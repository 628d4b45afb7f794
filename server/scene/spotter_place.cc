#include "scene/spotter_place.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "scene/view.h"
#include "volume/core_sight.h"
#include "volume/terrain.h"

namespace thunderhead::scene {
namespace {

// A tower of the height kTallTower_m or higher is viewed from a distance of kNearest_m to
// kFarthest_m. For a lower tower these distances shrink in proportion to its height.
constexpr double kTallTower_m = 12e3;
constexpr double kNearest_m = 15e3;
constexpr double kFarthest_m = 25e3;
constexpr double kStep_m = 500.0;
constexpr double kMaxSteps = 4000.0;  // the search leaves the domain within this many steps

// Shares of the picture's height. Ground fills kMinGround to kMaxGround, and kSkyAboveTop stays
// free above the tower's top.
constexpr double kMinGround = 1.0 / 6.0;
constexpr double kMaxGround = 0.25;
constexpr double kSkyAboveTop = 0.05;

constexpr int kDirections = 24;

// Weights of the costs of a place: the hidden tower, the hidden sky above it, and a view straight
// towards the sun. In a view towards the sun, the side of the storm that faces the eye is in
// shadow. The hidden base has the weight 1.
constexpr double kTowerWeight = 0.5;
constexpr double kSkyWeight = 0.5;
constexpr double kBacklitWeight = 1.0;

// A wide anvil hides the tower from eyes within kFarthest_m. Each side is therefore also tried at
// these multiples of kFarthest_m, and farther if cloud surrounds the eye there. Beyond kFarthest_m,
// each further kFarthest_m adds kDistanceWeight to the cost, because haze reduces contrast.
constexpr double kFarther[] = {1.5, 2.0};
constexpr double kDistanceWeight = 0.3;

// A side replaces another side that is nearer to the camera's own azimuth only if its cost is lower
// by at least this value.
constexpr double kNearEqual = 0.02;

// The elevations, in radians, at which a camera sees the storm's core.
struct CoreView {
  // Lowest elevation of the camera's axis, at which ground fills kMaxGround.
  double lowest_tilt = 0.0;
  // Highest elevation of the camera's axis, at which ground fills kMinGround.
  double highest_tilt = 0.0;
  double to_edge = 0.0;  // angle from the picture's middle to its upper edge
  double to_sky = 0.0;   // angle from the picture's middle to kSkyAboveTop below the upper edge
  double top = 0.0;      // top of the core

  bool TopFits() const { return top <= highest_tilt + to_sky; }
  double Tilt() const { return std::clamp(top - to_sky, lowest_tilt, highest_tilt); }
  double UpperEdge() const { return Tilt() + to_edge; }
};

CoreView CoreViewOf(const SpotterCamera& camera, const volume::HydrometeorFields& fields,
                    const volume::StormCore& core, double aspect_ratio) {
  const View view = ViewOf(camera, SiteOf(fields, camera.place_m), aspect_ratio);
  const auto to_band = [&view](double share) {
    return std::atan((1.0 - 2.0 * share) * view.tan_half_height);
  };
  const double dip =
      std::acos(kEffectiveEarthRadius_m / (kEffectiveEarthRadius_m + camera.eye_height_m));
  const glm::dvec3 top =
      view.local_from_world * (glm::dvec3(core.place_m, core.top_m) - view.eye_m);
  // The top of the core is a disc. Its near edge hides its middle, so the distance is that of the
  // near edge.
  const double distance_m = std::max(glm::length(glm::dvec2(top)) - core.Radius_m(), 1.0);
  return {to_band(kMaxGround) - dip, to_band(kMinGround) - dip, to_band(0.0), to_band(kSkyAboveTop),
          std::atan2(top.z, distance_m)};
}

// Finds places for a spotter. Its lines of sight assume a flat Earth.
class Stands {
 public:
  Stands(const volume::HydrometeorFields& fields, const volume::StormCore& core,
         physics::SizeSource sizes, const glm::dvec3& towards_sun, double aspect_ratio)
      : fields_(fields),
        core_(core),
        towards_sun_(towards_sun),
        aspect_ratio_(aspect_ratio),
        scale_(std::min(core.Height_m() / kTallTower_m, 1.0)),
        sight_(fields, core, sizes) {}

  // Returns `camera` placed so that it looks towards the core in the direction `azimuth_deg`. The
  // place is the nearest one, at least `nearest_m` away, that is clear of cloud and rain and shows
  // the top. From Farthest_m() on, it need not show the top.
  SpotterCamera Standing(SpotterCamera camera, double azimuth_deg, double nearest_m) const {
    camera.azimuth_deg = azimuth_deg;
    const glm::dvec2 towards(Direction(azimuth_deg, 0.0));
    const glm::dvec2 domain_m(fields_.grid.HighCorner_m() - fields_.grid.low_corner_m);
    const double outside_m = Farthest_m() + glm::length(domain_m);
    const double step_m = std::max(scale_ * kStep_m, outside_m / kMaxSteps);
    for (double distance_m = nearest_m;; distance_m += step_m) {
      camera.place_m = core_.place_m - distance_m * towards;
      if (distance_m >= outside_m) return camera;
      const bool far_enough =
          distance_m >= Farthest_m() || CoreViewOf(camera, fields_, core_, aspect_ratio_).TopFits();
      if (far_enough && sight_.IsClear(Eye(camera))) return camera;
    }
  }

  // Returns the cost of a place. It grows with the distance, with how directly the camera looks
  // towards the sun, and with the weighted hidden shares of the view.
  double Cost(const SpotterCamera& camera) const {
    const glm::dvec3 eye_m = Eye(camera);
    const double distance_m = glm::length(camera.place_m - core_.place_m);
    const CoreView view = CoreViewOf(camera, fields_, core_, aspect_ratio_);
    const double hidden = sight_.HiddenBase(eye_m) + kTowerWeight * sight_.HiddenTower(eye_m) +
                          kSkyWeight * sight_.HiddenSky(eye_m, view.UpperEdge());
    return hidden + kBacklitWeight * Backlit(camera) +
           kDistanceWeight * std::max(distance_m / Farthest_m() - 1.0, 0.0);
  }

  double Nearest_m() const { return scale_ * kNearest_m; }
  double Farthest_m() const { return scale_ * kFarthest_m; }

 private:
  // Returns a number from 0 to 1. It is 1 if the camera looks straight towards a low sun, and 0 if
  // the sun is behind the camera or at a right angle to it.
  double Backlit(const SpotterCamera& camera) const {
    if (towards_sun_.z <= 0.0) return 0.0;
    return std::max(glm::dot(Direction(camera.azimuth_deg, 0.0), towards_sun_), 0.0);
  }

  glm::dvec3 Eye(const SpotterCamera& camera) const {
    return {camera.place_m, volume::TerrainHeight_m(fields_, camera.place_m) + camera.eye_height_m};
  }

  const volume::HydrometeorFields& fields_;
  const volume::StormCore& core_;
  glm::dvec3 towards_sun_;
  double aspect_ratio_;
  double scale_;  // factor of the distances; below 1 for a tower lower than kTallTower_m
  volume::CoreSight sight_;
};

SpotterCamera OnBestSide(const Stands& stands, const SpotterCamera& camera) {
  SpotterCamera best = camera;
  double least_cost = std::numeric_limits<double>::infinity();
  const auto look_at = [&](double nearest_m) {
    for (int i = 0; i < kDirections; ++i) {
      // The tried directions alternate between right and left, with growing distance from the
      // camera's own azimuth. Among equal costs the nearest azimuth therefore wins.
      const int turn = i % 2 == 1 ? (i + 1) / 2 : -i / 2;
      const SpotterCamera standing =
          stands.Standing(camera, camera.azimuth_deg + turn * 360.0 / kDirections, nearest_m);
      const double cost = stands.Cost(standing);
      if (cost >= least_cost - kNearEqual) continue;
      best = standing;
      least_cost = cost;
    }
  };
  look_at(stands.Nearest_m());
  for (const double farther : kFarther) look_at(farther * stands.Farthest_m());
  return best;
}

}  // namespace

SpotterCamera SpottingCore(SpotterCamera camera, SpottersSide side,
                           const volume::HydrometeorFields& fields, const volume::StormCore& core,
                           physics::SizeSource sizes, const glm::dvec3& towards_sun,
                           double aspect_ratio) {
  const Stands stands(fields, core, sizes, towards_sun, aspect_ratio);
  camera = side == SpottersSide::kBest
               ? OnBestSide(stands, camera)
               : stands.Standing(camera, camera.azimuth_deg, stands.Nearest_m());
  return LookingAt(camera, fields, core, aspect_ratio);
}

SpotterCamera LookingAt(SpotterCamera camera, const volume::HydrometeorFields& fields,
                        const volume::StormCore& core, double aspect_ratio) {
  const glm::dvec2 towards_m = core.place_m - camera.place_m;
  if (glm::length(towards_m) > 0.0) {
    camera.azimuth_deg = glm::degrees(std::atan2(towards_m.x, towards_m.y));
  }
  camera.elevation_deg = glm::degrees(CoreViewOf(camera, fields, core, aspect_ratio).Tilt());
  return camera;
}

}  // namespace thunderhead::scene
