// A load on a server: one session, a presenter who turns its camera, and many viewers.
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

// The moving pictures that viewers ask for.
enum class LoadCodec { kJpeg, kVp9 };

// The times of a load that do not depend on what is asked for.
struct LoadTimes {
  double warm_up_s = 1.0;         // before the period, so that it holds no first times
  double sampling_s = 1.0;        // from one progress report, and sample of the server, to the next
  double visit_s = 2.0;           // of a passing viewer
  double join_patience_s = 60.0;  // with first frames, as the storm may have to be read
  double leave_patience_s = 5.0;  // with calls whose viewers leave
  double call_patience_s = 60.0;  // with other calls
};

struct LoadOptions {
  int viewers = 10;   // that read all that comes; 0 where all are throttled
  int looking = 0;    // of these, those who look around
  int throttled = 0;  // besides them
  int stalled = 0;    // besides them
  int passing = 0;    // besides them
  LoadCodec codec = LoadCodec::kJpeg;
  double kbit_per_s = 1000.0;  // that a throttled viewer reads
  double seconds = 10.0;
  int width_px = 640;
  int height_px = 360;
  double steer_hz = 30.0;  // updates a second, and motions of each who looks around; 0: none
  StillOptions stills;     // asked for when the measured time begins
  LoadTimes times;
};

// Makes viewers read at a limited rate: `throttled` besides the others, or all of them where no
// number is given.
void Throttle(double kbit_per_s, std::optional<int> throttled, LoadOptions& options);

// Of a load that runs.
struct Progress {
  double share = 0.0;  // of the time
  int joined = 0;      // viewers that have had a frame
  // The mean of healthy viewers since the last call; if there are none, of those who look around,
  // or of throttled ones.
  double frames_per_s = 0.0;
  // The fewest frames that any of those viewers, or of those who look around, has had within the
  // measured time.
  std::uint64_t least_frames = 0;
  std::size_t visits = 0;  // of passing viewers, that have ended
  int errors = 0;
};

// Runs until the time is over and every still has come, every viewer's call has ended, or a stop is
// requested, which gives the figures so far; an error if there are none. Streams that end with an
// error are counted in the report.
absl::StatusOr<Report> Run(const LoadOptions& options, Transport& transport,
                           const std::optional<ServerProcess>& server, const std::stop_token& stop,
                           const std::function<void(const Progress&)>& progress);

}  // namespace thunderhead::load
