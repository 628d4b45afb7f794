// Statistics of the shown pictures: rate, latency, bytes and decode time. The class has no clock;
// the caller passes the time. Any thread may call its methods.
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
    // Median time from sending a scene to showing it, over the last 60 scenes.
    std::optional<double> latency_ms;
    double decode_ms = 0.0;    // mean decode time per frame over the last two seconds
    std::uint64_t frames = 0;  // frames shown since the start
    std::uint64_t bytes = 0;   // bytes received since the start
  };

  // Reports a new stream, whose scene revisions may be counted from the start again.
  void StreamBegan();
  void Received(std::size_t bytes, TimePoint at);
  // Reports that the server accepted a scene of this client as this revision.
  void SceneTaken(std::uint64_t revision, TimePoint sent_at);
  // Reports that a frame of the session's view is on the screen.
  void Shown(std::uint64_t revision, double decode_ms, TimePoint at);
  // Reports that a frame of the client's own view is on the screen. Its scene revisions are counted
  // separately from the session's, so this frame gives no latency.
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
  // Send times, by revision, of the scenes that the server has accepted and that are not shown yet.
  std::map<std::uint64_t, TimePoint> sent_;
  std::map<std::uint64_t, TimePoint> shown_;  // when the newest revisions were shown, because a
                                              // scene's response may arrive after its frame
  std::deque<double> latencies_ms_;
  std::uint64_t frames_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace thunderhead::client
