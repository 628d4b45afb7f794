// The metrics of a running server: counters and histograms for the whole process. An update costs
// one or two atomic operations. This code does not depend on the code whose events it counts.
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

// A histogram of durations in seconds. The upper bounds of the buckets double from 1 ms to 16 s.
// The last bucket has no upper bound.
class Histogram {
 public:
  static constexpr std::size_t kBounds = 15;
  static constexpr double BoundOf(std::size_t bucket) {
    return 1e-3 * static_cast<double>(std::uint64_t{1} << bucket);
  }

  void Observe(double seconds);

  // Returns the number of values in one bucket. The counts are not cumulative. The bucket at
  // kBounds counts the values beyond the last bound.
  std::uint64_t Count(std::size_t bucket) const {
    return counts_[bucket].load(std::memory_order_relaxed);
  }
  double Sum() const { return static_cast<double>(sum_us_.Value()) * 1e-6; }

 private:
  std::array<std::atomic<std::uint64_t>, kBounds + 1> counts_{};
  Counter sum_us_;
};

// A set of counters or histograms, one for each value of a label. References that Of returns stay
// valid, so code that counts often can keep a reference.
template <typename Kind>
class Labelled {
 public:
  // Label values in `known` are reported from the start, with a count of 0. Otherwise an alert
  // would miss the first event, because Prometheus detects no increase in a series that begins with
  // it.
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
  Labelled<Counter> frames;    // number of frames drawn and encoded, by technique
  Labelled<Histogram> stages;  // duration of each stage of a frame, by stage
  Histogram update_to_frame;   // time from a scene change to a viewer's acknowledgement of the
                               // frame
  Counter frames_sent;         // frames sent to viewers
  Counter frames_skipped;      // frames that were replaced by newer frames before they were sent
  Counter frame_bytes_sent;    // bytes of the frames sent
  Labelled<Counter> refusals;  // error responses, by reason
  Counter sessions_opened;
  Counter session_save_failures;  // number of failed attempts to save sessions
  Counter session_damages;        // sessions not restored, or restored without their marks
  Labelled<Counter> job_pictures{"drawn", "failed", "dropped"};  // render jobs' images, by outcome
  Counter device_losses;  // times that the device was reset, or could not be opened again
  // Failures of the processes that read storm files, by kind of failure.
  Labelled<Counter> reader_failures{"time", "killed", "crashed", "nonsense"};
};

// Returns the metrics of the process.
Metrics& Counted();

}  // namespace thunderhead::telemetry
