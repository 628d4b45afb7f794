// Computes how much of the base and the tower of a storm's core is hidden from a camera position
// (eye) by condensate or terrain. Particle radii come from the size source that the scene chooses;
// all other optical properties are the defaults. This code does not depend on scenes.
#pragma once

#include <vector>

#include "glm/vec3.hpp"
#include "volume/hydrometeor_fields.h"
#include "volume/strongest_core.h"

namespace thunderhead::volume {

// The visibility of one storm core. Lengths in its criteria are fractions of the tower's height, so
// that shallow cumulus is treated like a thunderstorm. Light that terrain blocks counts as hidden.
// So does light from parts of the core outside the domain.
class CoreSight {
 public:
  // `fields` must outlive this object.
  CoreSight(const HydrometeorFields& fields, const StormCore& core,
            physics::SizeSource sizes = physics::SizeSource::kModel);

  // Returns the mean share of light from the lowest part of the tower that precipitation blocks
  // before it reaches `eye_m`. The lowest part is a quarter of the tower's height, at most 2 km.
  // Precipitation is rain, snow, graupel and hail.
  double HiddenBase(const glm::dvec3& eye_m) const;

  // Returns the mean share of light from the tower's near side that condensate blocks before it
  // reaches `eye_m`.
  double HiddenTower(const glm::dvec3& eye_m) const;

  // Returns the share of the light from the sky above the tower that condensate blocks before it
  // reaches `eye_m`. The light arrives at an elevation angle of `elevation` radians. The result is
  // near 1 if the eye is far under an anvil.
  double HiddenSky(const glm::dvec3& eye_m, double elevation) const;

  // Returns whether the air in front of the eye is clear: the first part of the sight lines to the
  // tower's base and top has almost no condensate.
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
  // Returns the point at a height above the core's ground. The point is `towards_m` nearer to the
  // eye than the core's axis, and `across_m` to the side of the axis.
  glm::dvec3 Target(const glm::dvec3& eye_m, double towards_m, double across_m,
                    double height_m) const;

  const HydrometeorFields& fields_;
  StormCore core_;
  std::vector<Term> all_;
  std::vector<Term> precipitation_;
};

}  // namespace thunderhead::volume
