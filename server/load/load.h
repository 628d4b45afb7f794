// A load on a server: one session with a presenter who turns its camera, and many viewers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "load/report.h"
#include "load/server_process.h"
#include "load/stills.h"
#include "load/transport.h"

namespace thunderhead::load {

// The encodings of frames that viewers ask for.
enum class LoadCodec { kJpeg, kVp9 };

// The times of a load that do not depend on the measured scenario.
struct LoadTimes {
  double warm_up_s = 1.0;         // before the period, so that first frames are excluded
  double sampling_s = 1.0;        // between two progress reports, and two samples of the server
  double visit_s = 2.0;           // of one visit of a passing viewer
  double join_patience_s = 60.0;  // timeout of first frames, as the storm may have to be read
  double leave_patience_s = 5.0;  // timeout of calls whose viewers leave
  double call_patience_s = 60.0;  // timeout of other calls
};

struct LoadOptions {
  int viewers = 10;   // that read everything; 0 if all are throttled
  int looking = 0;    // those of the viewers who look around
  int throttled = 0;  // in addition to the viewers
  int stalled = 0;    // in addition to the viewers
  int passing = 0;    // in addition to the viewers
  LoadCodec codec = LoadCodec::kJpeg;
  double kbit_per_s = 1000.0;  // read rate of a throttled viewer
  double seconds = 10.0;
  int width_px = 640;
  int height_px = 360;
  // Updates per second, and motions of each viewer who looks around; 0 for none.
  double steer_hz = 30.0;
  StillOptions stills;  // requested when the measured time begins
  LoadTimes times;
};

// Makes viewers read at a limited rate: `throttled` additional ones, or all of them if no number is
// given.
void Throttle(double kbit_per_s, std::optional<int> throttled, LoadOptions& options);

// The progress of a running load.
struct Progress {
  double share = 0.0;  // share of the time that has passed
  int joined = 0;      // viewers that have received a frame
  // The mean rate of healthy viewers since the last report. Without healthy viewers it is that of
  // viewers who look around, or of throttled ones.
  double frames_per_s = 0.0;
  // The lowest number of frames that any of those viewers, or of the viewers who look around,
  // received within the measured time.
  std::uint64_t least_frames = 0;
  std::size_t visits = 0;  // completed visits of passing viewers
  int errors = 0;
};

// Runs until the time has passed and every still has arrived. It ends early when every viewer's
// call has ended. A requested stop ends it with the figures so far, or with an error if there are
// none. Streams that end with an error are counted in the report.
absl::StatusOr<Report> Run(const LoadOptions& options, Transport& transport,
                           const std::optional<ServerProcess>& server, const std::stop_token& stop,
                           const std::function<void(const Progress&)>& progress);

}  // namespace thunderhead::load
