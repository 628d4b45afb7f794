#include "telemetry/metrics.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::telemetry {

void Histogram::Observe(double seconds) {
  std::size_t bucket = 0;
  while (bucket < kBounds && seconds > BoundOf(bucket)) ++bucket;
  counts_[bucket].fetch_add(1, std::memory_order_relaxed);
  sum_us_.Add(static_cast<std::uint64_t>(std::llround(std::max(seconds, 0.0) * 1e6)));
}

Metrics& Counted() {
  static Metrics metrics;
  return metrics;
}

}  // namespace thunderhead::telemetry
