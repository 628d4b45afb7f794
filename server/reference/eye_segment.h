// The first segment of a path, from the eye to the first object. It includes the air in front of
// that object, and ground, sky and sun as the eye sees them. Light that depends on the medium is
// returned as rays still to be traced. Paths on the CPU (path_radiance.h) and on the device
// (device_paths/device_tracer.h) therefore begin with the same code.
#pragma once

#include <optional>
#include <vector>

#include "glm/vec3.hpp"
#include "reference/brick_walk.h"
#include "reference/philox.h"
#include "reference/surroundings.h"

namespace thunderhead::reference {

double LargestColor(const glm::dvec3& color);

// Light that arrives through the medium. It is `radiance`, the value without the medium, times the
// transmittance along `ray` to infinity.
struct ThroughMedium {
  Ray ray;
  glm::dvec3 radiance{0.0};
};

// A reflection: the sunlight that arrives directly at its place, and the ray on which the path
// continues.
struct Bounce {
  ThroughMedium sunlight;
  Ray onward;
};

// Samples a reflection by Lambertian ground at `point_m`. `carried` is the path's throughput after
// the reflection.
Bounce ReflectDiffusely(const Surroundings& surroundings, const glm::dvec3& point_m,
                        const glm::dvec3& carried, RandomStream* random);

// Returns the distance at which `ray` meets the ground. It is infinite if the ray does not.
double GroundDistance_m(const Surroundings& surroundings, const Ray& ray);
// Returns the height of the ground above sea level at a place.
double GroundHeight_m(const Ground& ground, const glm::dvec3& point_m);

// Light that air has scattered before, which arrives along `ray` at a place on the eye's ray. If
// `ray` meets the medium, the missing light is `of_sky` minus `per_radiance` times the medium's
// radiance.
struct AirFromMedium {
  Ray ray;
  glm::dvec3 of_sky{0.0};
  glm::dvec3 per_radiance{0.0};
};

struct EyeSegment {
  glm::dvec3 radiance{0.0};           // independent of the medium
  std::vector<ThroughMedium> shaded;  // to be added
  std::optional<AirFromMedium> air;   // to be subtracted
  glm::dvec3 throughput{1.0};         // of the rest of the path
  enum class Then {
    kEnds,
    kScatters,  // scattered by the medium at `onward`'s origin, arriving in its direction
    kFlies      // leaves the ground along `onward`
  };
  Then then = Then::kEnds;
  Ray onward;
};

// Samples the segment of `ray`. The ray collides with the medium's particles at `collision_m`.
// Without a collision it meets the ground or leaves at `ground_m` (from GroundDistance_m).
EyeSegment FollowFromEye(const Surroundings& surroundings, const Ray& ray, double ground_m,
                         const std::optional<double>& collision_m, RandomStream* random);

}  // namespace thunderhead::reference
