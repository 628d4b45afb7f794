// Statistics of a load: percentiles, and latency from an update to the frame that shows it. Pure
// functions. Times are seconds on one clock.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace thunderhead::load {

// A frame that reached a viewer.
struct Arrival {
  double at_s = 0.0;
  std::uint64_t scene_revision = 0;
};

// An update that the server took.
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

// The least value that at least `share` of the values, 0 to 1, do not exceed; none if there are no
// values.
std::optional<double> Percentile(std::vector<double> values, double share);
std::optional<Percentiles> PercentilesOf(const std::vector<double>& values);
std::optional<Percentiles> PercentilesOf(const std::vector<Latency>& latencies);

// The latency at one viewer of each update sent in the period: until the first frame of its
// revision or a newer one. `updates` are in the order of their revisions, `arrivals` of time. An
// update that no frame had shown by the end counts with its age then, if that is more than any
// other latency: a viewer that gets nothing any more is late, not absent.
std::vector<Latency> LatenciesOf(const std::vector<Update>& updates,
                                 const std::vector<Arrival>& arrivals, const Period& period);

// For each update sent in the period that a viewer showed: the milliseconds from the first viewer
// that showed it, or a newer one, to the last. One that had not by the end counts until then.
// `updates` are in the order of their revisions, each viewer's arrivals in that of time.
std::vector<double> SpreadsOf(const std::vector<Update>& updates,
                              const std::vector<const std::vector<Arrival>*>& viewers,
                              const Period& period);

// The median latency of the updates sent in the first and in the last third of the period: how
// latency grows.
struct Growth {
  std::optional<double> first_third_ms;
  std::optional<double> last_third_ms;
};
Growth GrowthOf(const std::vector<Latency>& latencies, const Period& period);

// Frames a second over the whole period.
double FramesPerSecond(const std::vector<Arrival>& arrivals, const Period& period);

}  // namespace thunderhead::load
