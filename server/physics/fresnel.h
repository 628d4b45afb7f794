// Reflection and refraction of polarised rays at a plane boundary between two transparent media
// (Fresnel; signs as in Born and Wolf, chapter 1.5). An unpolarised ray is traced as two fields
// whose polarisations are perpendicular at its start. Its energy is the mean of the energies of the
// two fields.
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

  // Returns the mean energy of the two fields.
  double Energy() const;
};

// Returns an unpolarised ray of energy 1.
PolarizedRay UnpolarizedRay(const glm::dvec3& direction);

// The reflected and the refracted ray of `incident` at a boundary. The `normal` points to the side
// of the incident ray, so its dot product with the ray's direction is below 0. The `index_ratio` is
// the refractive index on that side divided by the index on the other side. Energies are fluxes
// through the boundary. The energies of both rays add up to the incident energy.
struct BoundaryRays {
  PolarizedRay reflected;
  PolarizedRay refracted;
  bool total_reflection = false;  // nothing is refracted
};
BoundaryRays CrossBoundary(const PolarizedRay& incident, const glm::dvec3& normal,
                           double index_ratio);

// Returns the reflectance for unpolarised light. `cosine` is that of the angle of incidence.
double Reflectance(double cosine, double index_ratio);

}  // namespace thunderhead::physics
