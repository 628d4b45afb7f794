// Writes metrics in Prometheus's text format.
#pragma once

#include <string>
#include <vector>

#include "telemetry/metrics.h"

namespace thunderhead::telemetry {

// A metric whose value is read when Prometheus requests the metrics, such as the number of
// sessions.
struct Gauge {
  std::string name;  // the metric's name, which ends with its unit, e.g. "thunderhead_memory_bytes"
  std::string help;
  double value = 0.0;
  // Most gauges have no label. Gauges of one name with different label values must be adjacent.
  std::string label = {};
  std::string label_value = {};
};

std::string Expose(const Metrics& metrics, const std::vector<Gauge>& gauges);

// Returns the bytes of memory that the process occupies, or 0 if the system does not report it.
double ResidentBytes();

}  // namespace thunderhead::telemetry
