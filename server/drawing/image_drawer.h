// Draws the pictures of an ImageQueue, in lanes beside the render loop. A picture that awaits
// traced light gives up its lane meanwhile. Used by the render loop's thread only.
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
#include "drawing/lane.h"
#include "drawing/light_tracer.h"
#include "drawing/measured_source.h"

namespace thunderhead::drawing {

struct ImageLimits {
  double max_predicted_s = 600.0;  // of one picture; those that are to take longer are refused
};

class ImageDrawer {
 public:
  // Pictures that are soon drawn have a lane of their own, so that they need not wait for those
  // that take long.
  struct Lanes {
    Lane& quick;
    Lane& any;
  };

  // All references must outlive it; the lanes' work must have ended before this does. `preparation`
  // is null if no scene needs any.
  ImageDrawer(const ImageLimits& limits, ImageQueue& queue, MeasuredSource& source,
              std::shared_ptr<Preparation> preparation, LightTracer& tracer, const Lanes& lanes,
              const base::TimeSource& time = base::SteadyTime());

  // Ends what is drawn or cancelled, admits what has come, and begins what can be begun.
  void Attend();
  // Ends what was begun, with this error what is not drawn; the lanes' work must have ended.
  void EndAll(const absl::Status& why);

 private:
  enum class Phase { kReading, kTracing, kMeasuring, kToRead, kToDraw, kDrawing };

  // A picture that was begun.
  struct Begun {
    ImageJob job;
    std::string name;  // in the tracer
    bool quick = false;
    Phase phase = Phase::kReading;
    Lane* lane = nullptr;  // that works for it
    std::shared_ptr<const volume::HydrometeorFields> fields;
    std::vector<StageTime> stages;  // before drawing
    std::int64_t wanted_paths = 0;
    std::optional<accuracy::MeasuredError> error;
    accuracy::MeasuredErrors measured;
    int refuted = 0;   // settings
    int attempts = 0;  // to draw it
    base::TimeSource::Clock::time_point begun_at{};
    // By the lane.
    absl::Status status;
    std::optional<DisplayFrame> frame;
  };

  absl::Status Admit(ImageJob& job) const;
  // Each works in a lane.
  static absl::Status Read(Begun& image, const std::shared_ptr<Preparation>& preparation);
  static absl::Status Draw(Begun& image, FrameSource& source);

  bool Suits(const Lane& lane, bool quick) const { return quick || &lane == &lanes_.any; }
  void WorkIn(Lane& lane, Begun& image);
  void Begin(Lane& lane);
  // True if it is to be drawn once more.
  static bool TriesAgain(Begun& image);
  // True if it is done.
  bool Ends(Begun& image);
  // The picture's next phase, before it is drawn.
  void Trace(Begun& image);
  void Measure(Begun& image);
  bool EndsTracing(Begun& image);
  void TakeStep(Begun& image, const TracedStep& step);
  // True if the picture has too much error for its scene, and begins anew with another setting.
  bool IsRefuted(Begun& image);
  void Report(const Begun& image, const accuracy::LightProgress& progress) const;
  absl::StatusOr<DisplayFrame> Drawn(Begun& image);

  const ImageLimits limits_;
  ImageQueue& queue_;
  MeasuredSource& source_;
  const std::shared_ptr<Preparation> preparation_;
  LightTracer& tracer_;
  const Lanes lanes_;
  const base::TimeSource& time_;
  std::list<Begun> begun_;
  std::uint64_t count_ = 0;  // of those begun
};

}  // namespace thunderhead::drawing
