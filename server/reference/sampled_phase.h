// Phase functions that paths can sample. Henyey and Greenstein's is sampled in closed form, any
// other by a table of its inverse cumulative distribution. Evaluation and sampling use exactly the
// same function, so both estimate the same light. This code does not depend on a medium.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"

namespace thunderhead::reference {

// A cosine of the scattering angle, sampled from one colour's phase function. `weight` holds, for
// each colour, the ratio of its phase function to the sampled function. It is 1 if the colours have
// the same function.
struct PhaseSample {
  double mu = 1.0;
  glm::dvec3 weight{1.0};
};

class SampledPhase {
 public:
  // A phase function of the cosine of the scattering angle. Over [-1, 1] it is finite and at least
  // 0, and not 0 everywhere.
  using Function = std::function<double(double mu)>;

  // `asymmetry` must lie inside (-1, 1).
  static SampledPhase HenyeyGreenstein(double asymmetry);
  // Normalises `function` to mean 1 over the sphere and tabulates it. The step between angles is
  // 0.0003 degrees at an angle of 0.01 degrees, and 0.04 degrees at 180 degrees.
  static SampledPhase Tabulated(const Function& function);
  // Tabulates one function for each colour: red, green, blue.
  static SampledPhase Tabulated(const std::array<Function, 3>& by_color);
  static SampledPhase Of(const physics::PhaseFunction& phase);

  // Returns the phase function, whose mean over the sphere is 1.
  glm::dvec3 Value(double mu) const;

  // Returns the mean cosine of the scattering angle, averaged over colours if they differ.
  double Asymmetry() const;

  // The table for one colour. It holds the function's values and its cumulative distribution at the
  // ends of intervals of x = 1 - mu. `guide` speeds up the search. For equal steps of the
  // cumulative distribution, it holds the interval at which a search starts.
  struct Table {
    const std::vector<double>& x;
    const std::vector<double>& values;
    const std::vector<double>& cumulative;
    const std::vector<std::uint32_t>& guide;
  };
  int Tables() const { return x_.empty() ? 0 : (colored_ ? 3 : 1); }
  // Returns the table of a colour, which must be below Tables().
  Table TableOf(std::size_t color) const {
    return {x_, values_[color], cumulative_[color], guide_[color]};
  }

  // Samples the scattering angle of `color` (0 to 2) by the inverse of its cumulative distribution
  // at `u`, uniform over (0, 1).
  PhaseSample Sample(double u, std::size_t color) const;

 private:
  SampledPhase() = default;
  void Normalize(std::size_t color);
  void Accumulate(std::size_t color);
  std::size_t IntervalOf(double u, std::size_t color) const;

  // Henyey and Greenstein's asymmetry parameter, used only if there is no table.
  double asymmetry_ = 0.0;
  bool colored_ = false;
  // The nodes of the table, which is piecewise linear in x = 1 - mu. Node i lies at the angle pi (i
  // / last)^2.
  std::vector<double> x_;
  // One entry for each colour. Only the first entry is used unless colored_ is true.
  std::array<std::vector<double>, 3> values_;
  std::array<std::vector<double>, 3> cumulative_;    // cumulative distribution, from 0 to 1
  std::array<std::vector<std::uint32_t>, 3> guide_;  // interval at which the search for u starts
};

}  // namespace thunderhead::reference
