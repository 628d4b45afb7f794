// The first segment of a path, from the eye to the first object. It includes the air in front of
// that object, and ground, sky and sun as the eye sees them. Light that depends on the medium is
// returned as rays that the caller must trace. Paths on the CPU (path_radiance.h) and on the device
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

// Light that arrives through the medium. Its value is `radiance`, which applies without the medium,
// times the medium's transmittance along `ray` to infinity.
struct ThroughMedium {
  Ray ray;
  glm::dvec3 radiance{0.0};
};

// A reflection: the sunlight that arrives directly at the reflecting point, and the ray on which
// the path continues.
struct Bounce {
  ThroughMedium sunlight;
  Ray onward;
};

// Samples a reflection by Lambertian ground at `point_m`. `carried` is the path's throughput after
// the reflection.
Bounce ReflectDiffusely(const Surroundings& surroundings, const glm::dvec3& point_m,
                        const glm::dvec3& carried, RandomStream* random);

// Returns the distance at which `ray` meets the ground, or infinity if it does not.
double GroundDistance_m(const Surroundings& surroundings, const Ray& ray);
// Returns the height of the ground above sea level at a place.
double GroundHeight_m(const Ground& ground, const glm::dvec3& point_m);

// Skylight that arrives along `ray` at a place in the air on the eye's ray, and that the air
// scatters to the eye. If `ray` meets the medium, the medium blocks the skylight `of_sky` and adds
// `per_radiance` times its own radiance. The missing light is the difference.
struct AirFromMedium {
  Ray ray;
  glm::dvec3 of_sky{0.0};
  glm::dvec3 per_radiance{0.0};
};

struct EyeSegment {
  glm::dvec3 radiance{0.0};           // radiance that does not depend on the medium
  std::vector<ThroughMedium> shaded;  // light to add, times the medium's transmittance
  std::optional<AirFromMedium> air;   // light to subtract
  glm::dvec3 throughput{1.0};         // throughput of the rest of the path
  enum class Then {
    kEnds,
    kScatters,  // `onward` is the arriving ray, from the point where the medium scatters it
    kFlies      // leaves the ground along `onward`
  };
  Then then = Then::kEnds;
  Ray onward;
};

// Samples the segment of `ray`. If `collision_m` has a value, the ray collides with a particle of
// the medium there. Otherwise it meets the ground at `ground_m` (from GroundDistance_m), or leaves
// to the sky if that is infinite.
EyeSegment FollowFromEye(const Surroundings& surroundings, const Ray& ray, double ground_m,
                         const std::optional<double>& collision_m, RandomStream* random);

}  // namespace thunderhead::reference
