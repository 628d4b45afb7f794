// Test cases with extreme input from storms or users, each with its analytic or limiting result.
// `thunderhead measure extremes` prints their results, and tests/accuracy runs the same list. The
// cases use the current GL context.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "measure/probe.h"

namespace thunderhead::measure {

struct Verdict {
  std::string expected;
  std::string got;
  bool passed = false;
};

struct Extreme {
  std::string name;  // for example "half_angle: optical depth per slice 1e-08, paper"
  std::function<absl::StatusOr<Verdict>(Probe& probe)> check;
};

// Returns first the cases of extreme files and numbers. Then follow the cases of pictures by
// half-angle slicing, the light volume and metaballs.
std::vector<Extreme> Extremes();

}  // namespace thunderhead::measure
