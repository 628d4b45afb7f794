// Figures of the shown pictures: rate, latency, bytes and decode time. The caller passes the time.
// Any thread may use it.
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
    double frames_per_s = 0.0;  // frames shown, over the last two seconds
    double bytes_per_s = 0.0;   // bytes received, over the last two seconds
    std::optional<double>
        latency_ms;            // median time from sending a scene to showing it, of the last 60
    double decode_ms = 0.0;    // mean over the last two seconds
    std::uint64_t frames = 0;  // frames shown since the start
    std::uint64_t bytes = 0;   // bytes received since the start
  };

  // Reports a new stream, whose revisions start again.
  void StreamBegan();
  void Received(std::size_t bytes, TimePoint at);
  // Reports that the server accepted a scene of this client as this revision.
  void SceneTaken(std::uint64_t revision, TimePoint sent_at);
  // Reports that a frame of the session's view is on the screen.
  void Shown(std::uint64_t revision, double decode_ms, TimePoint at);
  // Reports that a frame of the client's own view is on the screen. Its revisions are counted
  // separately.
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

  // These methods require mutex_.
  void Count(double decode_ms, TimePoint at);
  void AddLatency(TimePoint sent_at, TimePoint shown_at);

  mutable std::mutex mutex_;
  std::deque<Shot> shots_;
  std::deque<Parcel> parcels_;
  std::map<std::uint64_t, TimePoint> sent_;  // revisions accepted but not shown yet
  std::map<std::uint64_t, TimePoint>
      shown_;  // the newest revisions, because a response may arrive after its frame
  std::deque<double> latencies_ms_;
  std::uint64_t frames_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace thunderhead::client
