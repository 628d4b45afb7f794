// Traces light for views at rest and measures the errors of their pictures. A view belongs to a
// session, or is a single picture that waits for light. The tracer does one step for each view in
// turn, by a separate worker. Used by the render loop's thread only.
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
#include "drawing/worker.h"
#include "scene/scene.h"
#include "session/sessions.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::drawing {

// Delay before tracing is retried when light is traced for too many other scenes.
inline constexpr session::Clock::duration kTraceAgainAfter = std::chrono::milliseconds(500);

// The outcome of one step.
struct TracedStep {
  std::optional<accuracy::LightProgress> light;
  std::optional<accuracy::ErrorProgress> error;
};

class LightTracer {
 public:
  // The worker must outlive the tracer. The worker's work must have ended before the tracer is
  // destroyed.
  explicit LightTracer(Worker& worker) : worker_(worker) {}

  struct Request {
    std::shared_ptr<const scene::Scene> scene;
    std::shared_ptr<const volume::HydrometeorFields> fields;
    std::int64_t wanted_paths = 0;
    bool claims = false;  // keep the light while it is traced: do not evict it for another scene
    bool light = true;    // trace light
    bool error = false;   // measure the error
    // Maximum tracing time for measuring the error.
    double wanted_error_s = std::numeric_limits<double>::infinity();
  };
  // Traces for the view `who` until Stop is called, a step fails, or a step finds nothing to trace
  // or measure.
  void Want(const std::string& who, Request request);
  void Stop(const std::string& who);
  // Takes the progress of `who` since the last call, or the error of a failed step. Returns none if
  // there is no progress.
  std::optional<absl::StatusOr<TracedStep>> TakeNews(const std::string& who);

  // Takes the outcome of the step that the worker has finished, if any.
  void TakeOutcome(session::Clock::time_point now);
  // Begins the next step if no step is running. Returns when to call again, unless the loop is
  // woken earlier.
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
  // The outcome of a step, written by the worker's thread.
  struct Outcome {
    std::mutex mutex;
    std::optional<Progress> progress;
    accuracy::LightClaim claim;
  };

  Worker& worker_;
  std::map<std::string, Wanted> wanted_;
  std::string tracing_for_;  // name of the view for which the current or last step is done
  std::shared_ptr<const scene::Scene> tracing_scene_;
  std::shared_ptr<Outcome> outcome_;
};

}  // namespace thunderhead::drawing
