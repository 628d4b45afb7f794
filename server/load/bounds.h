// Bounds that a load's figures are to keep, so that a load can be a test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "load/report.h"

namespace thunderhead::load {

// Of viewers who read all that comes. Absent bounds hold.
struct Bounds {
  std::optional<double> min_fps;  // of the least served
  std::optional<double> max_p95_ms;
  std::optional<double> max_p99_ms;
  std::optional<double> max_spread_ms;  // the 99th percentile
  std::optional<double> max_growth_mb;  // of the server's memory, from its first figure to its last
};

// A sentence for each bound that is not kept. One whose figure was not measured is not kept.
std::vector<std::string> NotKept(const Bounds& bounds, const Report& report);

}  // namespace thunderhead::load
