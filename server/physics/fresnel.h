// Reflection and refraction of polarised rays at a plane boundary between two transparent media
// (Fresnel; signs as in Born and Wolf, chapter 1.5). Two fields, of waves that were polarised at
// right angles when the ray set out, travel with each ray: half their energies together is that of
// the unpolarised ray.
#pragma once

#include <array>

#include "glm/vec3.hpp"

namespace thunderhead::physics {

// A complex field vector.
struct FieldVector {
  glm::dvec3 re{0.0};
  glm::dvec3 im{0.0};
};

struct PolarizedRay {
  glm::dvec3 direction{0.0};
  std::array<FieldVector, 2> fields;

  // Mean energy of the two fields.
  double Energy() const;
};

// An unpolarised ray of energy 1.
PolarizedRay UnpolarizedRay(const glm::dvec3& direction);

// What leaves a boundary that `incident` meets. `normal` points back to the side it comes from (its
// dot product with the direction is below 0); `index_ratio` is the refractive index on that side
// over the one beyond. Energy is scaled to flux through the boundary: that of the two parts adds up
// to that of the incident ray.
struct BoundaryRays {
  PolarizedRay reflected;
  PolarizedRay refracted;
  bool total_reflection = false;  // nothing is refracted
};
BoundaryRays CrossBoundary(const PolarizedRay& incident, const glm::dvec3& normal,
                           double index_ratio);

// The share of unpolarised light reflected at a cosine of incidence.
double Reflectance(double cosine, double index_ratio);

}  // namespace thunderhead::physics
