// Statistics of a load test: percentiles, and the latency from an update to the frame that shows
// it. Pure functions. All times are seconds on one clock.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace thunderhead::load {

// The arrival of a frame at a viewer.
struct Arrival {
  double at_s = 0.0;
  std::uint64_t scene_revision = 0;
};

// An update of the scene that the server accepted.
struct Update {
  double sent_s = 0.0;
  std::uint64_t scene_revision = 0;
};

// The time over which a load is measured.
struct Period {
  double begin_s = 0.0;
  double end_s = 0.0;

  double Seconds() const { return end_s - begin_s; }
  bool Contains(double at_s) const { return at_s >= begin_s && at_s < end_s; }
};

struct Latency {
  double sent_s = 0.0;
  double ms = 0.0;
};

struct Percentiles {
  double p50 = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
};

// Returns the smallest value that is not exceeded by at least a share `share` (0 to 1) of the
// values. Returns nothing if there are no values.
std::optional<double> Percentile(std::vector<double> values, double share);
std::optional<Percentiles> PercentilesOf(const std::vector<double>& values);
std::optional<Percentiles> PercentilesOf(const std::vector<Latency>& latencies);

// Returns, for one viewer, the latency of each update that was sent in the period. The latency ends
// at the first frame with the update's revision or a newer one. `updates` must be ordered by
// revision, and `arrivals` by time. An update that was not shown by the end of the period counts
// with its age at that time, if this age exceeds all other latencies. A viewer that no longer
// receives frames therefore counts as late rather than as absent.
std::vector<Latency> LatenciesOf(const std::vector<Update>& updates,
                                 const std::vector<Arrival>& arrivals, const Period& period);

// Returns the spread of each update that was sent in the period and that at least one viewer
// showed. The spread is the time in milliseconds from the first viewer that showed the update or a
// newer one to the last such viewer. A viewer that had not shown it by the end of the period counts
// with that end. `updates` must be ordered by revision, and each viewer's arrivals by time.
std::vector<double> SpreadsOf(const std::vector<Update>& updates,
                              const std::vector<const std::vector<Arrival>*>& viewers,
                              const Period& period);

// The growth of latency: the median latency of the updates that were sent in the first and in the
// last third of the period.
struct Growth {
  std::optional<double> first_third_ms;
  std::optional<double> last_third_ms;
};
Growth GrowthOf(const std::vector<Latency>& latencies, const Period& period);

// Returns the frames per second over the whole period.
double FramesPerSecond(const std::vector<Arrival>& arrivals, const Period& period);

}  // namespace thunderhead::load
