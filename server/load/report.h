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

// Of the viewers of one kind.
struct ViewerFigures {
  int viewers = 0;
  double fps_min = 0.0;
  double fps_median = 0.0;
  std::optional<Percentiles> latency_ms;  // none if nothing was steered
  std::optional<Percentiles> spread_ms;   // from the first viewer who shows an update to the last
  Growth latency_growth;
  double kbit_per_viewer = 0.0;  // a second
  double bytes_per_frame = 0.0;
};

// From connecting to the first frame, of each time that viewers came.
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
  double cpu = 0.0;                                         // processors busy
};

struct StillFigures {
  int asked = 0;
  int came = 0;
  std::optional<double> median_ms;  // from asking to the picture
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
  ViewerFigures looking;  // without latencies, as own views count revisions of their own
  ViewerFigures throttled;
  int stalled = 0;
  FirstFrames healthy_first;
  FirstFrames looking_first;
  FirstFrames throttled_first;
  int passing = 0;
  FirstFrames passing_first;
  StillFigures stills;
  std::optional<ServerFigures> server;  // none if the server is not on this machine
  double own_cpu = 0.0;                 // processors that this program kept busy
  std::map<std::string, int> errors;    // counts by message

  int ErrorCount() const;
  // The viewers that the figures of the whole load are of: those that read all they get, or if
  // there are none those who look around, or throttled ones.
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
