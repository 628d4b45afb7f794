// Gives the pictures of an ImageQueue to workers, which draw them alongside the render loop. A
// picture that waits for the path-traced correction does not occupy a worker meanwhile. Used by the
// render loop's thread only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "accuracy/measured_errors.h"
#include "base/time_source.h"
#include "drawing/image_queue.h"
#include "drawing/light_tracer.h"
#include "drawing/measured_source.h"
#include "drawing/worker.h"

namespace thunderhead::drawing {

struct ImageLimits {
  // Maximum predicted drawing time of one picture; longer ones are refused.
  double max_predicted_s = 600.0;
};

class ImageDrawer {
 public:
  // Pictures with a short predicted time have a worker of their own, so that they do not wait for
  // long ones.
  struct Workers {
    Worker& quick;
    Worker& any;
  };

  // All references must outlive the drawer. The workers' work must have ended before the drawer is
  // destroyed. `preparation` is null if no scene needs preparation.
  ImageDrawer(const ImageLimits& limits, ImageQueue& queue, MeasuredSource& source,
              std::shared_ptr<Preparation> preparation, LightTracer& tracer, const Workers& workers,
              const base::TimeSource& time = base::SteadyTime());

  // Completes finished and cancelled pictures, admits new pictures, and starts pictures for which a
  // worker is free.
  void Attend();
  // Ends all started pictures. Those that are not drawn yet get their own error, or `why` if they
  // have none. The workers' work must have ended.
  void EndAll(const absl::Status& why);

 private:
  enum class Phase { kReading, kTracing, kMeasuring, kToRead, kToDraw, kDrawing };

  // A picture whose work has started.
  struct Begun {
    ImageJob job;
    std::string name;  // name in the light tracer
    bool quick = false;
    Phase phase = Phase::kReading;
    Worker* worker = nullptr;  // worker that works on it; null while no worker does
    std::shared_ptr<const volume::HydrometeorFields> fields;
    std::vector<StageTime> stages;  // costs of the stages before drawing
    std::int64_t wanted_paths = 0;
    std::optional<accuracy::MeasuredError> error;
    accuracy::MeasuredErrors measured;
    int refuted = 0;   // number of settings whose error turned out too large
    int attempts = 0;  // number of attempts to draw it
    base::TimeSource::Clock::time_point begun_at{};
    // Written by the worker.
    absl::Status status;
    std::optional<DisplayFrame> frame;
  };

  absl::Status Admit(ImageJob& job) const;
  // The following two functions run on a worker's thread.
  static absl::Status Read(Begun& image, const std::shared_ptr<Preparation>& preparation);
  static absl::Status Draw(Begun& image, FrameSource& source);

  bool Suits(const Worker& worker, bool quick) const { return quick || &worker == &workers_.any; }
  void WorkIn(Worker& worker, Begun& image);
  void Begin(Worker& worker);
  // Returns true if the picture must be drawn again.
  static bool TriesAgain(Begun& image);
  // Returns true if the picture is finished.
  bool Ends(Begun& image);
  // The following two functions begin the picture's next phase before it is drawn.
  void Trace(Begun& image);
  void Measure(Begun& image);
  bool EndsTracing(Begun& image);
  void TakeStep(Begun& image, const TracedStep& step);
  // Returns true if the picture's error is too large for its scene and another setting can be used.
  // The picture then starts again with that setting.
  bool IsRefuted(Begun& image);
  void Report(const Begun& image, const accuracy::LightProgress& progress) const;
  absl::StatusOr<DisplayFrame> Drawn(Begun& image);

  const ImageLimits limits_;
  ImageQueue& queue_;
  MeasuredSource& source_;
  const std::shared_ptr<Preparation> preparation_;
  LightTracer& tracer_;
  const Workers workers_;
  const base::TimeSource& time_;
  std::list<Begun> begun_;
  std::uint64_t count_ = 0;  // number of started pictures
};

}  // namespace thunderhead::drawing
