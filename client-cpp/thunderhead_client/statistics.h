// Figures of the pictures shown: rate, latency, bytes, time to decode. A plain value with a clock
// given; safe from any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>

namespace thunderhead::client {

class Statistics {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  struct Figures {
    double frames_per_s = 0.0;  // shown, over the last two seconds
    double bytes_per_s = 0.0;   // received, likewise
    std::optional<double>
        latency_ms;            // from sending a scene to showing it: the median of the last 60
    double decode_ms = 0.0;    // mean of those two seconds
    std::uint64_t frames = 0;  // shown since the start
    std::uint64_t bytes = 0;   // received since the start
  };

  // Revisions begin anew.
  void StreamBegan();
  void Received(std::size_t bytes, TimePoint at);
  // A scene of ours was taken as this revision.
  void SceneTaken(std::uint64_t revision, TimePoint sent_at);
  // A frame of the session's view is on the screen.
  void Shown(std::uint64_t revision, double decode_ms, TimePoint at);
  // A frame of the own view is on the screen; its revisions are counted apart.
  void ShownOwn(double decode_ms, TimePoint at);

  Figures At(TimePoint now) const;

 private:
  struct Shot {
    TimePoint at;
    double decode_ms = 0.0;
  };
  struct Parcel {
    TimePoint at;
    std::size_t bytes = 0;
  };

  // Need mutex_.
  void Count(double decode_ms, TimePoint at);
  void AddLatency(TimePoint sent_at, TimePoint shown_at);

  mutable std::mutex mutex_;
  std::deque<Shot> shots_;
  std::deque<Parcel> parcels_;
  std::map<std::uint64_t, TimePoint> sent_;   // taken, not shown yet
  std::map<std::uint64_t, TimePoint> shown_;  // the newest, as an answer may come after its frame
  std::deque<double> latencies_ms_;
  std::uint64_t frames_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace thunderhead::client
