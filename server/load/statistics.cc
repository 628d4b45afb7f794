#include "load/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

namespace thunderhead::load {
namespace {

// Returns for each update when the viewer first showed it or a newer one. If the viewer did not
// show it by the end of the period, this end is returned.
std::vector<double> ShownAt_s(const std::vector<Update>& updates,
                              const std::vector<Arrival>& arrivals, const Period& period) {
  std::vector<double> shown_s;
  shown_s.reserve(updates.size());
  auto arrival = arrivals.begin();
  for (const Update& update : updates) {
    while (arrival != arrivals.end() && arrival->scene_revision < update.scene_revision) ++arrival;
    shown_s.push_back(arrival == arrivals.end() ? period.end_s
                                                : std::min(arrival->at_s, period.end_s));
  }
  return shown_s;
}

}  // namespace

std::optional<double> Percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::nullopt;
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto at = static_cast<std::ptrdiff_t>(std::max(1.0, rank)) - 1;
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::optional<Percentiles> PercentilesOf(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return Percentiles{*Percentile(values, 0.5), *Percentile(values, 0.95),
                     *Percentile(values, 0.99)};
}

std::optional<Percentiles> PercentilesOf(const std::vector<Latency>& latencies) {
  std::vector<double> ms;
  ms.reserve(latencies.size());
  for (const Latency& latency : latencies) ms.push_back(latency.ms);
  return PercentilesOf(ms);
}

std::vector<Latency> LatenciesOf(const std::vector<Update>& updates,
                                 const std::vector<Arrival>& arrivals, const Period& period) {
  std::vector<Latency> latencies;
  std::vector<Latency> unseen;
  double longest_ms = 0.0;
  const std::vector<double> shown_s = ShownAt_s(updates, arrivals, period);
  for (std::size_t i = 0; i < updates.size(); ++i) {
    if (!period.Contains(updates[i].sent_s)) continue;
    const bool seen = shown_s[i] < period.end_s;
    const Latency latency{updates[i].sent_s, 1e3 * (shown_s[i] - updates[i].sent_s)};
    (seen ? latencies : unseen).push_back(latency);
    if (seen) longest_ms = std::max(longest_ms, latency.ms);
  }
  std::ranges::copy_if(unseen, std::back_inserter(latencies),
                       [&](const Latency& latency) { return latency.ms > longest_ms; });
  return latencies;
}

std::vector<double> SpreadsOf(const std::vector<Update>& updates,
                              const std::vector<const std::vector<Arrival>*>& viewers,
                              const Period& period) {
  std::vector<double> first_s(updates.size(), period.end_s);
  std::vector<double> last_s(updates.size(), 0.0);
  for (const std::vector<Arrival>* const arrivals : viewers) {
    const std::vector<double> shown_s = ShownAt_s(updates, *arrivals, period);
    for (std::size_t i = 0; i < updates.size(); ++i) {
      first_s[i] = std::min(first_s[i], shown_s[i]);
      last_s[i] = std::max(last_s[i], shown_s[i]);
    }
  }
  std::vector<double> spreads_ms;
  for (std::size_t i = 0; i < updates.size(); ++i) {
    if (!period.Contains(updates[i].sent_s) || first_s[i] >= period.end_s) continue;
    spreads_ms.push_back(1e3 * (last_s[i] - first_s[i]));
  }
  return spreads_ms;
}

Growth GrowthOf(const std::vector<Latency>& latencies, const Period& period) {
  const double third_s = period.Seconds() / 3.0;
  std::vector<double> first_ms;
  std::vector<double> last_ms;
  for (const Latency& latency : latencies) {
    if (latency.sent_s < period.begin_s + third_s) first_ms.push_back(latency.ms);
    if (latency.sent_s >= period.end_s - third_s) last_ms.push_back(latency.ms);
  }
  return {Percentile(std::move(first_ms), 0.5), Percentile(std::move(last_ms), 0.5)};
}

double FramesPerSecond(const std::vector<Arrival>& arrivals, const Period& period) {
  if (period.Seconds() <= 0.0) return 0.0;
  const auto count = std::ranges::count_if(
      arrivals, [&](const Arrival& arrival) { return period.Contains(arrival.at_s); });
  return static_cast<double>(count) / period.Seconds();
}

}  // namespace thunderhead::load
