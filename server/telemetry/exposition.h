// Metrics in Prometheus's text format.
#pragma once

#include <string>
#include <vector>

#include "telemetry/metrics.h"

namespace thunderhead::telemetry {

// A value at the time of asking, such as the number of sessions.
struct Gauge {
  std::string name;  // with its unit, e.g. "thunderhead_memory_bytes"
  std::string help;
  double value = 0.0;
  // Absent for most; gauges of one name that differ by it follow one another.
  std::string label = {};
  std::string label_value = {};
};

std::string Expose(const Metrics& metrics, const std::vector<Gauge>& gauges);

// Bytes of memory that the process occupies; 0 if the system does not tell.
double ResidentBytes();

}  // namespace thunderhead::telemetry
