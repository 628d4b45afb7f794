// Bounds that the figures of a load must satisfy, so that a load can be a test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "load/report.h"

namespace thunderhead::load {

// Bounds for the viewers who read everything they are sent. An absent bound is always satisfied.
struct Bounds {
  std::optional<double> min_fps;  // of the viewer with the lowest rate
  std::optional<double> max_p95_ms;
  std::optional<double> max_p99_ms;
  std::optional<double> max_spread_ms;  // the 99th percentile
  std::optional<double> max_growth_mb;  // of the server's memory, from its first figure to its last
};

// Returns a sentence for each violated bound. A bound also counts as violated if its figure was not
// measured.
std::vector<std::string> NotKept(const Bounds& bounds, const Report& report);

}  // namespace thunderhead::load
