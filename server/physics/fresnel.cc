#include "physics/fresnel.h"

#include <cmath>
#include <complex>

#include "glm/geometric.hpp"

namespace thunderhead::physics {
namespace {

using Complex = std::complex<double>;
using glm::dvec3;

// Returns a unit vector perpendicular to the unit vector `direction`.
dvec3 Perpendicular(const dvec3& direction) {
  const dvec3 axis = std::abs(direction.z) < 0.7 ? dvec3(0.0, 0.0, 1.0) : dvec3(1.0, 0.0, 0.0);
  return glm::normalize(glm::cross(direction, axis));
}

// Amplitude reflection coefficients perpendicular (s) and parallel (p) to the plane of incidence.
struct Coefficients {
  Complex s;
  Complex p;
  double refracted_cosine;  // 0 at total reflection
};

Coefficients CoefficientsAt(double cosine, double index_ratio) {
  const double sine2 = index_ratio * index_ratio * (1.0 - cosine * cosine);
  const bool total = sine2 >= 1.0;
  const Complex refracted =
      total ? Complex(0.0, std::sqrt(sine2 - 1.0)) : Complex(std::sqrt(1.0 - sine2), 0.0);
  return {(index_ratio * cosine - refracted) / (index_ratio * cosine + refracted),
          (cosine - index_ratio * refracted) / (cosine + index_ratio * refracted),
          refracted.real()};
}

FieldVector Compose(const Complex& s_part, const dvec3& s, const Complex& p_part, const dvec3& p) {
  return {s_part.real() * s + p_part.real() * p, s_part.imag() * s + p_part.imag() * p};
}

}  // namespace

double PolarizedRay::Energy() const {
  double energy = 0.0;
  for (const FieldVector& field : fields) {
    energy += 0.5 * (glm::dot(field.re, field.re) + glm::dot(field.im, field.im));
  }
  return energy;
}

PolarizedRay UnpolarizedRay(const dvec3& direction) {
  PolarizedRay ray{.direction = direction, .fields = {}};
  ray.fields[0].re = Perpendicular(direction);
  ray.fields[1].re = glm::cross(direction, ray.fields[0].re);
  return ray;
}

BoundaryRays CrossBoundary(const PolarizedRay& incident, const dvec3& normal, double index_ratio) {
  const dvec3& d = incident.direction;
  const double cosine = std::fmin(-glm::dot(d, normal), 1.0);
  const Coefficients r = CoefficientsAt(cosine, index_ratio);
  BoundaryRays rays;
  rays.total_reflection = r.refracted_cosine == 0.0;
  rays.reflected.direction = glm::normalize(d + 2.0 * cosine * normal);
  rays.refracted.direction =
      rays.total_reflection
          ? d
          : glm::normalize(index_ratio * d + (index_ratio * cosine - r.refracted_cosine) * normal);

  const dvec3 across = glm::cross(d, normal);
  const double length = glm::length(across);
  const dvec3 s = length > 1e-9 ? across / length : Perpendicular(d);
  const dvec3 p = glm::cross(d, s);
  const dvec3 p_reflected = glm::cross(rays.reflected.direction, s);
  const dvec3 p_refracted = glm::cross(rays.refracted.direction, s);
  // The energy that is not reflected is refracted, in phase with the incident field.
  const double t_s = std::sqrt(std::fmax(1.0 - std::norm(r.s), 0.0));
  const double t_p = std::sqrt(std::fmax(1.0 - std::norm(r.p), 0.0));
  for (std::size_t i = 0; i < incident.fields.size(); ++i) {
    const FieldVector& field = incident.fields[i];
    const Complex s_part(glm::dot(field.re, s), glm::dot(field.im, s));
    const Complex p_part(glm::dot(field.re, p), glm::dot(field.im, p));
    rays.reflected.fields[i] = Compose(r.s * s_part, s, r.p * p_part, p_reflected);
    if (!rays.total_reflection) {
      rays.refracted.fields[i] = Compose(t_s * s_part, s, t_p * p_part, p_refracted);
    }
  }
  return rays;
}

double Reflectance(double cosine, double index_ratio) {
  const Coefficients r = CoefficientsAt(cosine, index_ratio);
  return 0.5 * (std::norm(r.s) + std::norm(r.p));
}

}  // namespace thunderhead::physics
