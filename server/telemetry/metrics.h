// The figures of a running server: counters and histograms that cost an atomic operation or
// two, in one place for the whole process. Knows nothing of what it counts but the names.
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

// Seconds, in buckets that each reach twice as far as the one before: 1 ms to 16 s, and beyond.
class Histogram {
 public:
  static constexpr std::size_t kBounds = 15;
  static constexpr double BoundOf(std::size_t bucket) {
    return 1e-3 * static_cast<double>(std::uint64_t{1} << bucket);
  }

  void Observe(double seconds);

  // Of one bucket, not of those below it; that at kBounds is of what is beyond.
  std::uint64_t Count(std::size_t bucket) const {
    return counts_[bucket].load(std::memory_order_relaxed);
  }
  double Sum() const { return static_cast<double>(sum_us_.Value()) * 1e-6; }

 private:
  std::array<std::atomic<std::uint64_t>, kBounds + 1> counts_{};
  Counter sum_us_;
};

// One of a kind for each value of a label. Those found stay where they are: a place that counts
// often looks up its own once.
template <typename Kind>
class Labelled {
 public:
  // Values that are known beforehand are told from the start, at 0: Prometheus sees no increase in
  // what it has not seen before, so an alert would miss the first.
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

// The names that operators see stand in exposition.cc.
struct Metrics {
  Labelled<Counter> frames;    // drawn and encoded, by technique
  Labelled<Histogram> stages;  // of frames, by stage
  Histogram update_to_frame;   // from a change of the scene to a viewer's acknowledgement of it
  Counter frames_sent;         // to viewers
  Counter frames_skipped;      // newer ones came first
  Counter frame_bytes_sent;    // of their pictures
  Labelled<Counter> refusals;  // answers that are errors, by reason
  Counter sessions_opened;
  Counter session_save_failures;  // attempts to save sessions that failed
  Labelled<Counter> job_pictures{"drawn", "failed", "dropped"};  // of render jobs, by outcome
  Counter device_losses;  // the device was reset, or could not be opened again
  // Of storm files' readers, by what happened.
  Labelled<Counter> reader_failures{"time", "killed", "crashed", "nonsense"};
};

// The process's.
Metrics& Counted();

}  // namespace thunderhead::telemetry
