// Computes how much of the base and the tower of a storm's core is hidden from an eye by condensate
// or terrain. A scene chooses only the source of the particles' sizes; the other optics are the
// defaults. This code does not depend on scenes.
#pragma once

#include <vector>

#include "glm/vec3.hpp"
#include "volume/hydrometeor_fields.h"
#include "volume/strongest_core.h"

namespace thunderhead::volume {

// The visibility of one core. Its lengths are shares of the tower's height, so that shallow cumulus
// is treated like a thunderstorm.
class CoreSight {
 public:
  // `fields` must outlive this object.
  CoreSight(const HydrometeorFields& fields, const StormCore& core,
            physics::SizeSource sizes = physics::SizeSource::kModel);

  // Returns the share of the light from the tower's lowest quarter (at most 2 km) that
  // precipitation hides from `eye_m`. Precipitation is rain, snow, graupel and hail.
  double HiddenBase(const glm::dvec3& eye_m) const;

  // Returns the share of the light from the tower's near side that condensate blocks from `eye_m`.
  double HiddenTower(const glm::dvec3& eye_m) const;

  // Returns the share of light that condensate blocks from `eye_m`, of the light from the sky at an
  // elevation above the tower, in radians. It is 1 if the eye is too far under an anvil to see the
  // top.
  double HiddenSky(const glm::dvec3& eye_m, double elevation) const;

  // Returns whether neither cloud nor rain dims the start of the sight lines to base and top.
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
  // Returns the point at a height above the core's ground. It is `towards_m` nearer to the eye than
  // the core, and `across_m` to its side.
  glm::dvec3 Target(const glm::dvec3& eye_m, double towards_m, double across_m,
                    double height_m) const;

  const HydrometeorFields& fields_;
  StormCore core_;
  std::vector<Term> all_;
  std::vector<Term> precipitation_;
};

}  // namespace thunderhead::volume
