// A path's first segment, from the eye to what it meets: the air in front of that, the ground, sky
// and sun as the eye sees them. What only the medium can tell is left as questions, so that paths
// of the processors (path_radiance.h) and of the device (device_paths/device_tracer.h) begin alike.
#pragma once

#include <optional>
#include <vector>

#include "glm/vec3.hpp"
#include "reference/brick_walk.h"
#include "reference/philox.h"
#include "reference/surroundings.h"

namespace thunderhead::reference {

double LargestColor(const glm::dvec3& color);

// Light that arrives through the medium: the radiance without it, times the transmittance along
// `ray` to its end at infinity.
struct ThroughMedium {
  Ray ray;
  glm::dvec3 radiance{0.0};
};

// A place at which light is reflected: what arrives there directly, and where the path goes on.
struct Bounce {
  ThroughMedium sunlight;
  Ray onward;
};

// By Lambertian ground at `point_m`; `carried` is the path's throughput after it.
Bounce ReflectDiffusely(const Surroundings& surroundings, const glm::dvec3& point_m,
                        const glm::dvec3& carried, RandomStream* random);

// Where `ray` meets the ground; infinite if it does not.
double GroundDistance_m(const Surroundings& surroundings, const Ray& ray);
// Above sea level, at a place.
double GroundHeight_m(const Ground& ground, const glm::dvec3& point_m);

// Light that air has scattered before, and which comes to a place on the eye's ray along `ray`: if
// that meets the medium, `of_sky` less `per_radiance` times the medium's light is missing.
struct AirFromMedium {
  Ray ray;
  glm::dvec3 of_sky{0.0};
  glm::dvec3 per_radiance{0.0};
};

struct EyeSegment {
  glm::dvec3 radiance{0.0};           // whatever the medium does
  std::vector<ThroughMedium> shaded;  // to be added
  std::optional<AirFromMedium> air;   // to be subtracted
  glm::dvec3 throughput{1.0};         // of the path, where it goes on
  enum class Then {
    kEnds,
    kScatters,  // by the medium, at `onward`'s origin, having come in its direction
    kFlies      // from the ground
  };
  Then then = Then::kEnds;
  Ray onward;
};

// The segment of `ray`, which comes to the medium's particles after `collision_m`, or else meets
// the ground or leaves at `ground_m` (GroundDistance_m).
EyeSegment FollowFromEye(const Surroundings& surroundings, const Ray& ray, double ground_m,
                         const std::optional<double>& collision_m, RandomStream* random);

}  // namespace thunderhead::reference
