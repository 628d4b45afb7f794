// The figures of a load, as text and as JSON.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "load/recording.h"
#include "load/statistics.h"

namespace thunderhead::load {

// The figures of all viewers of one kind.
struct ViewerFigures {
  int viewers = 0;
  double fps_min = 0.0;
  double fps_median = 0.0;
  std::optional<Percentiles> latency_ms;  // absent if the presenter did not steer
  std::optional<Percentiles> spread_ms;   // from the first viewer that shows an update to the last
  Growth latency_growth;
  double kbit_per_viewer = 0.0;  // per second
  double bytes_per_frame = 0.0;
};

// Times from connecting to the first frame, for each visit of a viewer.
struct FirstFrames {
  std::size_t count = 0;
  std::optional<double> median_ms;
  std::optional<double> most_ms;
};

struct ServerFigures {
  double rss_first_mb = 0.0;
  double rss_last_mb = 0.0;
  double rss_most_mb = 0.0;
  std::vector<std::pair<double, double>> rss_over_time_mb;  // seconds and memory, at most 20
  double cpu = 0.0;                                         // number of busy processors
};

struct StillFigures {
  int asked = 0;
  int came = 0;
  std::optional<double> median_ms;  // from the request to the picture
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
  ViewerFigures looking;  // without latencies, because own views count their own revisions
  ViewerFigures throttled;
  int stalled = 0;
  FirstFrames healthy_first;
  FirstFrames looking_first;
  FirstFrames throttled_first;
  int passing = 0;
  FirstFrames passing_first;
  StillFigures stills;
  std::optional<ServerFigures> server;  // absent if the server is not on this machine
  double own_cpu = 0.0;                 // number of processors that this program kept busy
  std::map<std::string, int> errors;    // counts by message

  int ErrorCount() const;
  // Returns the viewers that represent the whole load: the healthy ones, or without them the ones
  // who look around, or the throttled ones.
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
