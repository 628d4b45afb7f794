// A load test of a server: one session with a presenter who turns the camera, and many viewers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "load/image_burst.h"
#include "load/report.h"
#include "load/server_process.h"
#include "load/transport.h"

namespace thunderhead::load {

// The encodings of frames that viewers ask for.
enum class LoadCodec { kJpeg, kVp9 };

// The times of a load test that are not part of the measured scenario.
struct LoadTimes {
  // Time before the measured period, so that first frames are excluded.
  double warm_up_s = 1.0;
  // Time between two progress reports, and between two samples of the server.
  double sampling_s = 1.0;
  double visit_s = 2.0;  // duration of one visit of a passing viewer
  // Timeout of the first frame of each viewer, during which the storm may have to be read.
  double join_patience_s = 60.0;
  double leave_patience_s = 5.0;  // timeout for calls to end after their viewers leave
  double call_patience_s = 60.0;  // timeout of other calls
};

struct LoadOptions {
  int viewers = 10;   // number of viewers that read everything; 0 if all are throttled
  int looking = 0;    // number of these viewers who look around (in an own view)
  int throttled = 0;  // number of throttled viewers, in addition to `viewers`
  int stalled = 0;    // number of stalled viewers, in addition to `viewers`
  int passing = 0;    // number of passing viewers, in addition to `viewers`
  LoadCodec codec = LoadCodec::kJpeg;
  double kbit_per_s = 1000.0;  // rate at which a throttled viewer reads
  double seconds = 10.0;
  int width_px = 640;
  int height_px = 360;
  // Updates per second by the presenter, and camera moves per second by each viewer who looks
  // around; 0 for none.
  double steer_hz = 30.0;
  ImageBurstOptions images;  // requested when the measured period begins
  LoadTimes times;
};

// Sets the number of viewers that read at a limited rate: `throttled` viewers in addition to the
// others, or all viewers if `throttled` is absent.
void Throttle(double kbit_per_s, std::optional<int> throttled, LoadOptions& options);

// The progress of a running load.
struct Progress {
  double share = 0.0;  // passed share of the measured time, 0 to 1
  int joined = 0;      // number of viewers that have received a frame
  // The mean frame rate of healthy viewers (ViewerKind) since the last report. Without healthy
  // viewers, it is the rate of the viewers who look around, or else of the throttled viewers.
  double frames_per_s = 0.0;
  // The number of frames that the slowest viewer received within the measured period. It considers
  // viewers of the kind that frames_per_s counts, and viewers who look around.
  std::uint64_t least_frames = 0;
  std::size_t visits = 0;  // completed visits of passing viewers
  int errors = 0;
};

// Runs the load test until its time has passed and every image has arrived, or until every viewer's
// call has ended. If `stop` is requested, it ends early with the results so far, or with an error
// if there are none. Streams that end with an error are counted in the report.
absl::StatusOr<Report> Run(const LoadOptions& options, Transport& transport,
                           const std::optional<ServerProcess>& server, const std::stop_token& stop,
                           const std::function<void(const Progress&)>& progress);

}  // namespace thunderhead::load
