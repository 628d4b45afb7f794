// The results of a load test, as text and as JSON.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "load/recording.h"
#include "load/statistics.h"

namespace thunderhead::load {

// The results of all viewers of one kind.
struct ViewerFigures {
  int viewers = 0;
  double fps_min = 0.0;
  double fps_median = 0.0;
  std::optional<Percentiles> latency_ms;  // absent if the presenter did not steer
  // Time from the first viewer that shows an update to the last.
  std::optional<Percentiles> spread_ms;
  Growth latency_growth;
  double kbit_per_viewer = 0.0;  // mean data rate of a viewer
  double bytes_per_frame = 0.0;
};

// The times from connecting to the first frame, over all visits of the viewers of one kind.
struct FirstFrames {
  std::size_t count = 0;
  std::optional<double> median_ms;
  std::optional<double> most_ms;
};

struct ServerFigures {
  double rss_first_mb = 0.0;
  double rss_last_mb = 0.0;
  double rss_most_mb = 0.0;
  // Pairs of seconds and memory, at most 20.
  std::vector<std::pair<double, double>> rss_over_time_mb;
  double cpu = 0.0;  // mean number of busy processors
};

struct ImageBurstFigures {
  int asked = 0;
  int came = 0;
  std::optional<double> median_ms;  // median time from the request to the picture
  std::optional<double> most_ms;
};

struct Report {
  std::string transport;
  double seconds = 0.0;
  int width_px = 0;
  int height_px = 0;
  double steer_hz = 0.0;
  double throttle_kbit_per_s = 0.0;
  ViewerFigures healthy;
  ViewerFigures looking;  // has no latencies, because own views count their revisions separately
  ViewerFigures throttled;
  int stalled = 0;
  FirstFrames healthy_first;
  FirstFrames looking_first;
  FirstFrames throttled_first;
  int passing = 0;
  FirstFrames passing_first;
  ImageBurstFigures images;
  std::optional<ServerFigures> server;  // absent if the server is not on this machine
  double own_cpu = 0.0;                 // number of processors that this program kept busy
  std::map<std::string, int> errors;    // number of errors by message

  int ErrorCount() const;
  // Returns the results that represent the whole load: those of the healthy viewers. Without
  // healthy viewers, they are those of the viewers who look around, or else of the throttled
  // viewers.
  const ViewerFigures& Main() const {
    if (healthy.viewers > 0) return healthy;
    return looking.viewers > 0 ? looking : throttled;
  }
  const FirstFrames& MainFirst() const {
    if (healthy.viewers > 0) return healthy_first;
    return looking.viewers > 0 ? looking_first : throttled_first;
  }
};

Report ReportOf(const Recording& recording);
std::string ToText(const Report& report);
std::string ToJson(const Report& report);

}  // namespace thunderhead::load
