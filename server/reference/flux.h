// Fluxes of sunlight through a domain, by tracing photons from the sun: domain means with standard
// errors. Every photon is counted in exactly one place where it ends, so that those shares add up
// to 1 to the last bit. Colours are averaged: albedo and phase function are the means over red,
// green, blue.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "absl/status/statusor.h"
#include "glm/vec3.hpp"
#include "reference/medium.h"

namespace thunderhead::reference {

// The domain is a box around the medium's (equal to it in x and y if the medium is periodic).
// Sunlight falls on its whole top face, and on nothing else: with open sides, a slanted beam leaves
// the lower part of one side unlit. Photons that leave through an open side do not come back.
struct FluxProblem {
  std::shared_ptr<const Medium> medium;
  glm::dvec3 domain_low_m{0.0};
  glm::dvec3 domain_high_m{0.0};
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};  // unit, above the horizon
  double ground_albedo = 0.0;             // Lambertian, at the domain's bottom

  // The domain is the medium's own box.
  static FluxProblem Of(std::shared_ptr<const Medium> medium, const glm::dvec3& towards_sun);
};

struct FluxOptions {
  std::int64_t photons = 1'000'000;
  double seconds = 0.0;  // time limit, except for the first photons; 0: none
  std::uint64_t seed = 0;
  int threads = 0;  // 0: as many as the machine has
};

// A share of the sunlight on the domain's top.
struct FluxShare {
  double value = 0.0;
  double standard_error = 0.0;
};

struct FluxResult {
  FluxShare reflectance;    // leaves through the top
  FluxShare transmittance;  // arrives at the bottom, counted at each arrival: direct + diffuse
  FluxShare transmittance_direct;   // never scattered or reflected before
  FluxShare transmittance_diffuse;  // the rest
  FluxShare absorptance;            // in the medium
  FluxShare sides;                  // leaves through the sides
  FluxShare ground_absorptance;     // transmittance less the share that the ground reflects
  std::int64_t photons = 0;
};

// Called between groups of photons with the share done.
using FluxObserver = std::function<void(double share)>;

// Traces photons until `photons` are done, the time limit is reached or `stop` asks to stop (with
// the result so far). For a given number of photons the result is the same, bit for bit, for any
// number of threads. Fails if the sun is not above the horizon, the ground's albedo is not 0 to 1,
// or no photon was traced.
absl::StatusOr<FluxResult> ComputeFlux(const FluxProblem& problem, const FluxOptions& options,
                                       const FluxObserver& observer, const std::stop_token& stop);

}  // namespace thunderhead::reference
