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

// A tower as high or higher is seen from kNearest_m to kFarthest_m, a lower one from
// proportionally nearer.
constexpr double kTallTower_m = 12e3;
constexpr double kNearest_m = 15e3;
constexpr double kFarthest_m = 25e3;
constexpr double kStep_m = 500.0;
constexpr double kMaxSteps = 4000.0;  // to outside the domain

// Shares of the picture's height.
constexpr double kMinGround = 1.0 / 6.0;
constexpr double kMaxGround = 0.25;
constexpr double kSkyAboveTop = 0.05;

constexpr int kDirections = 24;

// Weights of the hidden tower, of the hidden sky above it, and of looking straight against the sun,
// where all that faces the eye is in shadow; the hidden base counts as 1.
constexpr double kTowerWeight = 0.5;
constexpr double kSkyWeight = 0.5;
constexpr double kBacklitWeight = 1.0;

// Under a wide anvil nothing of the tower is seen from less than kFarthest_m. So on each side
// places this many times as far are looked at, too, and as far again as it takes to be clear of
// cloud; they cost this much for each further kFarthest_m, as haze takes contrast.
constexpr double kFarther[] = {1.5, 2.0};
constexpr double kDistanceWeight = 0.3;

// By which a side must be better than one that is nearer to the camera's own azimuth.
constexpr double kNearEqual = 0.02;

// The storm's core as a camera sees it. Angles are elevations in radians.
struct CoreView {
  double lowest_tilt = 0.0;   // of the camera: shows kMaxGround
  double highest_tilt = 0.0;  // shows kMinGround
  double to_edge = 0.0;       // from the picture's middle to its upper edge
  double to_sky = 0.0;        // to kSkyAboveTop below that
  double top = 0.0;           // of the core

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
  // Its near side hides the top's middle.
  const double distance_m = std::max(glm::length(glm::dvec2(top)) - core.Radius_m(), 1.0);
  return {to_band(kMaxGround) - dip, to_band(kMinGround) - dip, to_band(0.0), to_band(kSkyAboveTop),
          std::atan2(top.z, distance_m)};
}

// Finds places to stand. Sight lines are those of a flat Earth.
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

  // `camera` on the side from which it looks to `azimuth_deg`, as near as shows the top and is
  // clear of cloud and rain, but not nearer than `nearest_m`.
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

  // Cost of a place: its distance, how far it looks against the sun, and the weighted shares of the
  // view that are hidden from it.
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
  // From 0, with the sun behind or beside the camera, to 1, against a low sun.
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
  double scale_;  // of lengths, where the tower is low
  volume::CoreSight sight_;
};

SpotterCamera OnBestSide(const Stands& stands, const SpotterCamera& camera) {
  SpotterCamera best = camera;
  double least_cost = std::numeric_limits<double>::infinity();
  const auto look_at = [&](double nearest_m) {
    for (int i = 0; i < kDirections; ++i) {
      // To the right and to the left in turns, ever farther from the camera's own azimuth.
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
