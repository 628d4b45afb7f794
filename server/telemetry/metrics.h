// The metrics of a running server: counters and histograms that cost an atomic operation or two, in
// one place for the whole process. This code depends only on the names of what it counts.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

namespace thunderhead::telemetry {

class Counter {
 public:
  void Add(std::uint64_t count = 1) { value_.fetch_add(count, std::memory_order_relaxed); }
  std::uint64_t Value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

// A histogram of seconds. Each bucket reaches twice as far as the one before, from 1 ms to 16 s,
// and the last has no upper bound.
class Histogram {
 public:
  static constexpr std::size_t kBounds = 15;
  static constexpr double BoundOf(std::size_t bucket) {
    return 1e-3 * static_cast<double>(std::uint64_t{1} << bucket);
  }

  void Observe(double seconds);

  // Returns the count of one bucket, without those below it. The bucket at kBounds counts the
  // values beyond the last bound.
  std::uint64_t Count(std::size_t bucket) const {
    return counts_[bucket].load(std::memory_order_relaxed);
  }
  double Sum() const { return static_cast<double>(sum_us_.Value()) * 1e-6; }

 private:
  std::array<std::atomic<std::uint64_t>, kBounds + 1> counts_{};
  Counter sum_us_;
};

// One counter or histogram for each value of a label. References stay valid, so code that counts
// often can look one up once.
template <typename Kind>
class Labelled {
 public:
  // Values that are known beforehand are reported from the start, at 0. Prometheus sees no increase
  // in a series that it has not seen before, so an alert would miss the first event.
  explicit Labelled(std::initializer_list<std::string_view> known = {}) {
    for (const std::string_view value : known) Of(value);
  }

  Kind& Of(std::string_view value) {
    const std::lock_guard lock(mutex_);
    const auto at = kinds_.find(value);
    return at != kinds_.end() ? at->second : kinds_[std::string(value)];
  }

  template <typename Visit>
  void ForEach(const Visit& visit) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [value, kind] : kinds_) visit(value, kind);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Kind, std::less<>> kinds_;
};

// The names that operators see are in exposition.cc.
struct Metrics {
  Labelled<Counter> frames;    // drawn and encoded, by technique
  Labelled<Histogram> stages;  // duration of frames' stages, by stage
  Histogram update_to_frame;   // from a scene change to a viewer's acknowledgement
  Counter frames_sent;         // frames sent to viewers
  Counter frames_skipped;      // replaced by newer ones before they were sent
  Counter frame_bytes_sent;    // bytes of the frames sent
  Labelled<Counter> refusals;  // error responses, by reason
  Counter sessions_opened;
  Counter session_save_failures;  // attempts to save sessions that failed
  Labelled<Counter> job_pictures{"drawn", "failed", "dropped"};  // render jobs' images, by outcome
  Counter device_losses;  // the device was reset, or could not be opened again
  // Failures of storm files' readers, by what happened.
  Labelled<Counter> reader_failures{"time", "killed", "crashed", "nonsense"};
};

// Returns the metrics of the process.
Metrics& Counted();

}  // namespace thunderhead::telemetry
