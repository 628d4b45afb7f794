// How much of the base and of the tower of a storm's core condensate or terrain hides from an eye.
// Of the optics only the particles' sizes are a scene's; knows no scene.
#pragma once

#include <vector>

#include "glm/vec3.hpp"
#include "volume/hydrometeor_fields.h"
#include "volume/strongest_core.h"

namespace thunderhead::volume {

// Lengths in it are shares of the tower's height, so that shallow cumulus is seen as a thunderstorm
// is.
class CoreSight {
 public:
  // `fields` must outlive it.
  CoreSight(const HydrometeorFields& fields, const StormCore& core,
            physics::SizeSource sizes = physics::SizeSource::kModel);

  // The share of the light from the lowest quarter of the tower, and at most 2 km, that rain, snow,
  // graupel and hail keep from `eye_m`.
  double HiddenBase(const glm::dvec3& eye_m) const;

  // The share of the light from the tower's near side that any condensate keeps from `eye_m`.
  double HiddenTower(const glm::dvec3& eye_m) const;

  // The share of the light from the sky at an elevation above the tower, in radians, that any
  // condensate keeps from `eye_m`: 1 where the eye is too far under an anvil to see the top.
  double HiddenSky(const glm::dvec3& eye_m, double elevation) const;

  // True if neither cloud nor rain dims the beginning of the sight lines to base and top.
  bool IsClear(const glm::dvec3& eye_m) const;

 private:
  struct Term {
    const HydrometeorField* field;
    MassExtinction mass_extinction;
  };

  double Extinction_per_m(const std::vector<Term>& terms, const glm::dvec3& point_m) const;
  double OpticalDepth(const std::vector<Term>& terms, const glm::dvec3& from_m,
                      const glm::dvec3& to_m) const;
  double Hidden(const std::vector<Term>& terms, const glm::dvec3& eye_m,
                const glm::dvec3& target_m) const;
  // The point at a height above the core's ground, `towards_m` nearer to the eye than the core and
  // `across_m` beside it.
  glm::dvec3 Target(const glm::dvec3& eye_m, double towards_m, double across_m,
                    double height_m) const;

  const HydrometeorFields& fields_;
  StormCore core_;
  std::vector<Term> all_;
  std::vector<Term> precipitation_;
};

}  // namespace thunderhead::volume
