// Traces light for views at rest and measures the errors of their pictures. The views are sessions,
// and pictures that wait for light. It takes one step for each in turn, in a separate lane. Used by
// the render loop's thread only.
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

// Delay before tracing is tried again while light is traced for too many other scenes.
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
    bool claims = false;  // while it traces, its light is not evicted for another scene
    bool light = true;    // trace light
    bool error = false;   // measure the error
    double wanted_error_s = std::numeric_limits<double>::infinity();  // tracing time for the error
  };
  // Traces until Stop is called, or until a step fails or finds nothing to trace or measure.
  void Want(const std::string& who, Request request);
  void Stop(const std::string& who);
  // Takes the progress since the last call, or the error of a failed step.
  std::optional<absl::StatusOr<TracedStep>> TakeNews(const std::string& who);

  // Takes the outcome of a finished step.
  void TakeOutcome(session::Clock::time_point now);
  // Begins the next step if none is running. Returns when to call again if no wake-up comes
  // earlier.
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
  // The outcome of a step, written by the lane's thread.
  struct Outcome {
    std::mutex mutex;
    std::optional<Progress> progress;
    accuracy::LightClaim claim;
  };

  Lane& lane_;
  std::map<std::string, Wanted> wanted_;
  std::string tracing_for_;  // who the current or last step is for
  std::shared_ptr<const scene::Scene> tracing_scene_;
  std::shared_ptr<Outcome> outcome_;
};

}  // namespace thunderhead::drawing
