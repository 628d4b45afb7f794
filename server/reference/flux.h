// Fluxes of sunlight through a domain, computed by tracing photons from the sun. The results are
// domain means with standard errors. Every photon ends in exactly one way, so the shares of these
// ends add up to exactly 1. Colours are averaged: albedo and phase function are the means over red,
// green and blue.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "absl/status/statusor.h"
#include "glm/vec3.hpp"
#include "reference/medium.h"

namespace thunderhead::reference {

// The input of a flux computation. The domain is a box around the medium's box. It equals the
// medium's box in x and y if the medium is periodic. Sunlight falls only on the domain's whole top
// face. With open sides, a slanted beam therefore leaves the lower part of one side unlit. Photons
// that leave through an open side do not return.
struct FluxProblem {
  std::shared_ptr<const Medium> medium;
  glm::dvec3 domain_low_m{0.0};
  glm::dvec3 domain_high_m{0.0};
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};  // unit vector, above the horizon
  double ground_albedo = 0.0;             // Lambertian ground at the domain's bottom

  // Creates a problem whose domain is the medium's own box.
  static FluxProblem Of(std::shared_ptr<const Medium> medium, const glm::dvec3& towards_sun);
};

struct FluxOptions {
  std::int64_t photons = 1'000'000;
  // Time limit in seconds, which the first photons may exceed. 0 means no limit.
  double seconds = 0.0;
  std::uint64_t seed = 0;
  int threads = 0;  // number of threads; 0 means as many as the machine has
};

// A share of the sunlight that falls on the domain's top.
struct FluxShare {
  double value = 0.0;
  double standard_error = 0.0;
};

struct FluxResult {
  FluxShare reflectance;  // share that leaves through the top
  // Share that arrives at the bottom, the sum of direct and diffuse. A photon counts at each
  // arrival.
  FluxShare transmittance;
  FluxShare transmittance_direct;  // share that arrives without scattering or reflection before
  // Share that arrives after at least one scattering or reflection.
  FluxShare transmittance_diffuse;
  FluxShare absorptance;         // share absorbed in the medium
  FluxShare sides;               // share that leaves through the sides
  FluxShare ground_absorptance;  // transmittance minus the share that the ground reflects
  std::int64_t photons = 0;
};

// A callback that receives the finished share of the work from time to time.
using FluxObserver = std::function<void(double share)>;

// Traces photons until `photons` are done, the time limit is reached or `stop` requests a stop.
// When stopped, it returns the result of the photons traced so far. For a given number of photons
// the result is bit-identical for any number of threads. Returns INVALID_ARGUMENT if the sun is not
// above the horizon or the ground's albedo is not within 0 to 1. It returns the same if the number
// of photons is below 1 or the domain does not fit the medium. Returns CANCELLED if no photon was
// traced.
absl::StatusOr<FluxResult> ComputeFlux(const FluxProblem& problem, const FluxOptions& options,
                                       const FluxObserver& observer, const std::stop_token& stop);

}  // namespace thunderhead::reference
