// The record of a load test, from which its report is made.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "load/server_process.h"
#include "load/statistics.h"

namespace thunderhead::load {

// Returns the current time in seconds, on the clock that all recorded times use.
inline double Now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

enum class ViewerKind {
  kHealthy,    // reads everything at once, and follows the session's view
  kLooking,    // looks around: reads everything in its own view, whose camera it turns
  kThrottled,  // reads at a limited rate
  kStalled,    // joins and never reads
  kPassing,    // leaves without notice and returns, repeatedly
};

struct ViewerRecord {
  ViewerKind kind = ViewerKind::kHealthy;
  std::vector<double> first_frames_ms;  // times from connecting to the first frame, for each visit
  std::vector<Arrival> frames;
  // Totals within the measured period.
  std::uint64_t bytes = 0;
  std::uint64_t frame_count = 0;
  std::uint64_t frame_bytes = 0;
};

// Counts errors by message. Safe to call from any thread.
class Errors {
 public:
  void Add(const std::string& message) {
    const std::lock_guard lock(mutex_);
    ++counts_[message];
  }
  std::map<std::string, int> Counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, int> counts_;
};

// The record of single pictures.
struct ImageBurstRecord {
  int asked = 0;
  // Times from the request to the picture, for each picture that arrived.
  std::vector<double> came_ms;
};

struct Recording {
  Period period;
  std::vector<Update> updates;  // in the order of their revisions
  std::vector<const ViewerRecord*> viewers;
  ImageBurstRecord images;
  std::vector<ProcessSample> server;  // empty if the server is not on this machine
  double own_cpu_s = 0.0;             // processor time of this program within the period
  std::map<std::string, int> errors;
};

}  // namespace thunderhead::load
