// Traces light for whoever rests, and measures the error of their pictures: of sessions, and of
// pictures that await it, a step for one after another in a lane of its own. Used by the render
// loop's thread only.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "accuracy/error_meters.h"
#include "accuracy/light_progress.h"
#include "drawing/lane.h"
#include "scene/scene.h"
#include "session/sessions.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::drawing {

// Delay before tracing is tried again when light is traced for too many other scenes.
inline constexpr session::Clock::duration kTraceAgainAfter = std::chrono::milliseconds(500);

// The progress of a step.
struct TracedStep {
  std::optional<accuracy::LightProgress> light;
  std::optional<accuracy::ErrorProgress> error;
};

class LightTracer {
 public:
  // The lane must outlive it, and its work must have ended before this does.
  explicit LightTracer(Lane& lane) : lane_(lane) {}

  struct Request {
    std::shared_ptr<const scene::Scene> scene;
    std::shared_ptr<const volume::HydrometeorFields> fields;
    std::int64_t wanted_paths = 0;
    bool claims = false;  // while it traces, the light is not given up for another's
    bool light = true;    // it is traced
    bool error = false;   // it is measured
    double wanted_error_s = std::numeric_limits<double>::infinity();  // of tracing for the error
  };
  // Traces until Stop, or until a step fails or finds nothing to trace and nothing to measure.
  void Want(const std::string& who, Request request);
  void Stop(const std::string& who);
  // The progress since the last call, or why there is none.
  std::optional<absl::StatusOr<TracedStep>> TakeNews(const std::string& who);

  // Takes what a step has brought since the last call.
  void TakeOutcome(session::Clock::time_point now);
  // Begins the next step if none is under way. Returns when to call again without a wake-up.
  std::optional<session::Clock::time_point> Begin(session::Clock::time_point now);

 private:
  using Progress = absl::StatusOr<TracedStep>;

  struct Wanted {
    Request request;
    accuracy::LightClaim claim = nullptr;
    std::optional<Progress> news = std::nullopt;
    session::Clock::time_point not_before{};
    bool ended = false;
  };
  static Progress Trace(FrameSource& source, const Request& request, accuracy::LightClaim* claim);
  static bool Ends(const Request& request, const TracedStep& step);
  // The outcome of a step, by the lane's thread.
  struct Outcome {
    std::mutex mutex;
    std::optional<Progress> progress;
    accuracy::LightClaim claim;
  };

  Lane& lane_;
  std::map<std::string, Wanted> wanted_;
  std::string tracing_for_;  // or the last
  std::shared_ptr<const scene::Scene> tracing_scene_;
  std::shared_ptr<Outcome> outcome_;
};

}  // namespace thunderhead::drawing
