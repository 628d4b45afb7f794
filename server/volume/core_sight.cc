#include "volume/core_sight.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "glm/vec2.hpp"
#include "glm/vector_relational.hpp"
#include "volume/terrain.h"

namespace thunderhead::volume {
namespace {

// These lengths are shares of the tower's height.
constexpr double kBaseHeight = 0.25;
constexpr double kBaseRadius = 1.0 / 3.0;
constexpr double kClearDistance = 1.0 / 12.0;
constexpr double kSkyBehind = 4.0;

constexpr double kHighestBase_m = 2000.0;

// The optical depth that is returned when the ground blocks the line of sight.
constexpr double kOpaqueDepth = 100.0;

// Maximum optical depth near the eye, towards the core, that counts as clear of cloud and rain.
constexpr double kClearOpticalDepth = 0.05;

bool Falls(physics::Hydrometeor hydrometeor) {
  return hydrometeor != physics::Hydrometeor::kCloud && hydrometeor != physics::Hydrometeor::kIce;
}

}  // namespace

CoreSight::CoreSight(const HydrometeorFields& fields, const StormCore& core,
                     physics::SizeSource sizes)
    : fields_(fields), core_(core) {
  for (const HydrometeorField& field : fields.fields) {
    if (field.concentration_kg_per_m3.empty()) continue;
    const Term term{&field,
                    MassExtinctionOf(field, physics::DefaultOptics(field.hydrometeor), sizes)};
    all_.push_back(term);
    if (Falls(field.hydrometeor)) precipitation_.push_back(term);
  }
}

double CoreSight::HiddenBase(const glm::dvec3& eye_m) const {
  const double radius_m = kBaseRadius * core_.Height_m();
  const double height_m = std::min(kBaseHeight * core_.Height_m(), kHighestBase_m);
  double sum = 0.0;
  int count = 0;
  for (const double across : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    for (const double towards : {0.0, 0.5}) {
      for (const double up : {0.25, 0.75}) {
        sum += Hidden(precipitation_, eye_m,
                      Target(eye_m, towards * radius_m, across * radius_m, up * height_m));
        ++count;
      }
    }
  }
  return sum / count;
}

double CoreSight::HiddenTower(const glm::dvec3& eye_m) const {
  const double radius_m = core_.Radius_m();
  double sum = 0.0;
  int count = 0;
  for (const double across : {-0.5, 0.0, 0.5}) {
    for (const double up : {0.2, 0.4, 0.6, 0.8}) {
      sum += Hidden(all_, eye_m, Target(eye_m, radius_m, across * radius_m, up * core_.Height_m()));
      ++count;
    }
  }
  return sum / count;
}

double CoreSight::HiddenSky(const glm::dvec3& eye_m, double elevation) const {
  const double rise_m = fields_.grid.HighCorner_m().z - eye_m.z;
  if (elevation <= 0.0 || rise_m <= 0.0) return 0.0;
  const double behind_m =
      glm::distance(glm::dvec2(eye_m), core_.place_m) + kSkyBehind * core_.Height_m();
  const double reach_m = std::min(rise_m / std::tan(elevation), behind_m);
  double sum = 0.0;
  int count = 0;
  for (const double across : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    const glm::dvec3 beside_m = Target(eye_m, 0.0, across * core_.Radius_m(), 0.0);
    const glm::dvec2 towards = glm::normalize(glm::dvec2(beside_m - eye_m));
    const glm::dvec3 to_m = eye_m + reach_m * glm::dvec3(towards, std::tan(elevation));
    sum += 1.0 - std::exp(-OpticalDepth(all_, eye_m, to_m));
    ++count;
  }
  return sum / count;
}

bool CoreSight::IsClear(const glm::dvec3& eye_m) const {
  for (const double up : {0.5 * kBaseHeight, 1.0}) {
    const glm::dvec3 towards = Target(eye_m, 0.0, 0.0, up * core_.Height_m()) - eye_m;
    const double share = std::min(kClearDistance * core_.Height_m() / glm::length(towards), 1.0);
    if (OpticalDepth(all_, eye_m, eye_m + share * towards) > kClearOpticalDepth) return false;
  }
  return true;
}

double CoreSight::Extinction_per_m(const std::vector<Term>& terms,
                                   const glm::dvec3& point_m) const {
  const RegularGrid& grid = fields_.grid;
  const glm::ivec3 cell(glm::floor((point_m - grid.low_corner_m) / grid.spacing_m));
  const CellBox& box = fields_.condensate;
  if (glm::any(glm::lessThan(cell, box.low)) || glm::any(glm::greaterThanEqual(cell, box.high))) {
    return 0.0;
  }
  float sum = 0.0F;
  for (const Term& term : terms) {
    AddExtinction(*term.field, term.mass_extinction, grid.Offset(cell.x, cell.y, cell.z), 1, &sum);
  }
  return sum;
}

double CoreSight::OpticalDepth(const std::vector<Term>& terms, const glm::dvec3& from_m,
                               const glm::dvec3& to_m) const {
  const glm::dvec3 in_cells = (to_m - from_m) / fields_.grid.spacing_m;
  const double cells =
      std::max({std::abs(in_cells.x), std::abs(in_cells.y), std::abs(in_cells.z), 1.0});
  const int steps = static_cast<int>(std::ceil(cells));
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const glm::dvec3 point_m = glm::mix(from_m, to_m, (i + 0.5) / steps);
    if (point_m.z < TerrainHeight_m(fields_, glm::dvec2(point_m))) return kOpaqueDepth;
    sum += Extinction_per_m(terms, point_m);
  }
  return sum * glm::length(to_m - from_m) / steps;
}

double CoreSight::Hidden(const std::vector<Term>& terms, const glm::dvec3& eye_m,
                         const glm::dvec3& target_m) const {
  const glm::dvec3 low_m = fields_.grid.low_corner_m;
  const glm::dvec3 high_m = fields_.grid.HighCorner_m();
  // A target outside the domain counts as hidden, because the storm is cut off at the domain's
  // face.
  if (target_m.x < low_m.x || target_m.y < low_m.y || target_m.x > high_m.x ||
      target_m.y > high_m.y) {
    return 1.0;
  }
  return 1.0 - std::exp(-OpticalDepth(terms, eye_m, target_m));
}

glm::dvec3 CoreSight::Target(const glm::dvec3& eye_m, double towards_m, double across_m,
                             double height_m) const {
  const glm::dvec2 off_m = glm::dvec2(eye_m) - core_.place_m;
  const double distance_m = glm::length(off_m);
  const glm::dvec2 towards = distance_m > 0.0 ? off_m / distance_m : glm::dvec2(0.0, -1.0);
  const glm::dvec2 across(towards.y, -towards.x);
  return {core_.place_m + towards_m * towards + across_m * across, core_.ground_m + height_m};
}

}  // namespace thunderhead::volume
