// Lets a worker draw sessions' long frames one after another, so that they do not delay the render
// loop. A frame is drawn in pieces, and other work gets its turn on the device between two pieces.
// The drawing can be cancelled when the scene has changed. Used by the render loop's thread only.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "drawing/frame_planner.h"
#include "drawing/frame_source.h"
#include "drawing/worker.h"
#include "frame/fine_image.h"

namespace thunderhead::drawing {

class SessionWorker {
 public:
  // `has_room` returns true if that many more bytes fit on the device without making other sources
  // free memory. The worker must outlive this object, and the worker's work must have ended before
  // this object is destroyed.
  SessionWorker(Worker& worker, std::function<bool(std::uint64_t bytes)> has_room)
      : worker_(worker), has_room_(std::move(has_room)) {}

  struct Request {
    std::string session_id;
    std::shared_ptr<const scene::Scene> scene;
    std::shared_ptr<const volume::HydrometeorFields> fields;
    FrameQuality quality;
    bool checked = false;  // also draw with half the slices, to measure the discretisation error
    bool fine = false;     // also return the picture with more than 8 bits per channel
  };
  struct Picture {
    DisplayFrame frame;
    std::optional<double> discretisation_error;  // set if Request::checked was
    std::optional<frame::FineImage> fine;        // absent if not requested or not available
  };

  // Returns true if the worker's source already holds the scene's extinction, or if the device has
  // room for `bytes` more bytes. The caller passes the expected size of the scene on the device.
  bool HasRoomFor(const scene::Scene& scene, std::uint64_t bytes) const {
    return FirstDirty(last_drawn_, scene) > scene::Stage::kExtinction || has_room_(bytes);
  }
  // Returns true if no frame is being drawn and no outcome waits to be taken.
  bool IsFree() const { return outcome_ == nullptr; }
  // Returns true while the session's frame is being drawn or its outcome waits to be taken.
  bool IsFor(const std::string& session_id) const {
    return !IsFree() && request_.session_id == session_id;
  }
  // Returns the session of the last request.
  const std::string& For() const { return request_.session_id; }
  // Starts drawing. The worker must be free.
  void Begin(Request request);
  // Cancels the drawing before its next piece. Its outcome is then CANCELLED.
  void Cancel();
  // Returns the outcome of the request once the drawing has ended; none before.
  std::optional<absl::StatusOr<Picture>> Take();

  bool WantsTurn() { return worker_.WantsTurn(); }
  // Lets the worker draw one piece. Returns when it is drawn.
  void GiveTurn() { worker_.GiveTurn(); }

  // Returns the frame that the worker's source drew last, whose stages it can reuse; none after a
  // failure.
  const std::optional<LastDrawn>& Last() const { return last_drawn_; }
  // Forgets the last frame. Call it when the worker gets a new source.
  void Forget() { last_drawn_.reset(); }

 private:
  struct Outcome {
    std::mutex mutex;
    std::optional<absl::StatusOr<Picture>> picture;
  };

  Worker& worker_;
  std::function<bool(std::uint64_t bytes)> has_room_;
  Request request_;
  std::shared_ptr<Outcome> outcome_;
  std::shared_ptr<std::atomic<bool>> cancelled_;
  std::optional<LastDrawn> last_drawn_;
};

}  // namespace thunderhead::drawing
