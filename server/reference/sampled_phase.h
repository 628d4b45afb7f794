// Phase functions that a path can sample: Henyey and Greenstein's in closed form, any other by a
// table of its inverse cumulative distribution. Values and samples come from one and the same
// function, so that sampled and evaluated light agree exactly. Knows no medium.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"

namespace thunderhead::reference {

// A cosine of scattering angle sampled from one colour's phase function. `weight` is the ratio of
// each colour's function to that one: 1 unless they differ.
struct PhaseSample {
  double mu = 1.0;
  glm::dvec3 weight{1.0};
};

class SampledPhase {
 public:
  // A phase function of the cosine of the scattering angle: finite, at least 0, and somewhere
  // above 0 over [-1, 1].
  using Function = std::function<double(double mu)>;

  // `asymmetry` lies inside (-1, 1).
  static SampledPhase HenyeyGreenstein(double asymmetry);
  // Normalised here, to mean 1 over the sphere. Steps of angle are 0.0005 degrees at 0.01 degrees
  // and 0.04 degrees at 180.
  static SampledPhase Tabulated(const Function& function);
  // One function for each colour: red, green, blue.
  static SampledPhase Tabulated(const std::array<Function, 3>& by_color);
  static SampledPhase Of(const physics::PhaseFunction& phase);

  // The phase function; its mean over the sphere is 1.
  glm::dvec3 Value(double mu) const;

  // Maps `u`, uniform over (0, 1), to the scattering angle within which that share of the light of
  // `color` (0 to 2) goes.
  PhaseSample Sample(double u, std::size_t color) const;

 private:
  SampledPhase() = default;
  void Normalize(std::size_t color);
  void Accumulate(std::size_t color);
  std::size_t IntervalOf(double u, std::size_t color) const;

  // Henyey and Greenstein's parameter; unused where there is a table.
  double asymmetry_ = 0.0;
  bool colored_ = false;
  // The table: piecewise linear in x = 1 - mu between nodes, which lie at angles pi (i / last)^2.
  std::vector<double> x_;
  // By colour; only the first unless colored_.
  std::array<std::vector<double>, 3> values_;
  std::array<std::vector<double>, 3> cumulative_;    // 0 to 1
  std::array<std::vector<std::uint32_t>, 3> guide_;  // interval in which to start the search for u
};

}  // namespace thunderhead::reference
