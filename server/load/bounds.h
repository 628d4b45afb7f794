// Bounds that the results of a load must satisfy, so that a load run can serve as a test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "load/report.h"

namespace thunderhead::load {

// Bounds on the results of the viewers that Report::Main returns. An absent bound is always
// satisfied.
struct Bounds {
  std::optional<double> min_fps;  // minimum frame rate of the slowest viewer
  std::optional<double> max_p95_ms;
  std::optional<double> max_p99_ms;
  std::optional<double> max_spread_ms;  // maximum of the 99th percentile of the spread
  // Maximum growth of the server's memory, from the first sample to the last.
  std::optional<double> max_growth_mb;
};

// Returns a sentence for each bound that is violated. A bound also counts as violated if its value
// was not measured.
std::vector<std::string> NotKept(const Bounds& bounds, const Report& report);

}  // namespace thunderhead::load
