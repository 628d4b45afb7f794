// Draws sessions' long frames one after another in a lane, so that they do not hold up the render
// loop. It draws in pieces; between two pieces other work gets its turn on the device. A changed
// scene can cancel the drawing. Used by the render loop's thread only.
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
#include "drawing/lane.h"
#include "frame/fine_image.h"

namespace thunderhead::drawing {

class SessionLane {
 public:
  // `has_room` says whether that many more bytes fit on the device without making others free
  // memory. The lane must outlive it, and its work must have ended before this is destroyed.
  SessionLane(Lane& lane, std::function<bool(std::uint64_t bytes)> has_room)
      : lane_(lane), has_room_(std::move(has_room)) {}

  struct Request {
    std::string session_id;
    std::shared_ptr<const scene::Scene> scene;
    std::shared_ptr<const volume::HydrometeorFields> fields;
    FrameQuality quality;
    bool checked = false;  // also draw with half the slices
    bool fine = false;     // also make it with more bits per channel
  };
  struct Picture {
    DisplayFrame frame;
    std::optional<double> discretisation_error;  // set if it was checked
    std::optional<frame::FineImage> fine;        // none if not requested or not available
  };

  // Returns true if the lane already holds the scene's extinction, or has room for the `bytes` that
  // it takes in another source.
  bool HasRoomFor(const scene::Scene& scene, std::uint64_t bytes) const {
    return FirstDirty(last_drawn_, scene) > scene::Stage::kExtinction || has_room_(bytes);
  }
  // Returns true if nothing is being drawn and no outcome waits to be taken.
  bool IsFree() const { return outcome_ == nullptr; }
  // Returns true while the session's frame is drawn or its outcome waits.
  bool IsFor(const std::string& session_id) const {
    return !IsFree() && request_.session_id == session_id;
  }
  // The session of the last request.
  const std::string& For() const { return request_.session_id; }
  // Starts drawing. The lane must be free.
  void Begin(Request request);
  // Ends the drawing at its next piece; its outcome is CANCELLED.
  void Cancel();
  // Returns the outcome of the request once it has ended.
  std::optional<absl::StatusOr<Picture>> Take();

  bool WantsTurn() { return lane_.WantsTurn(); }
  // Lets the lane draw one piece. Returns when it is drawn.
  void GiveTurn() { lane_.GiveTurn(); }

  // The frame that the lane's source drew last, whose stages it can reuse; none after a failure.
  const std::optional<LastDrawn>& Last() const { return last_drawn_; }
  // Forgets the last frame. Call it when the lane gets another source.
  void Forget() { last_drawn_.reset(); }

 private:
  struct Outcome {
    std::mutex mutex;
    std::optional<absl::StatusOr<Picture>> picture;
  };

  Lane& lane_;
  std::function<bool(std::uint64_t bytes)> has_room_;
  Request request_;
  std::shared_ptr<Outcome> outcome_;
  std::shared_ptr<std::atomic<bool>> cancelled_;
  std::optional<LastDrawn> last_drawn_;
};

}  // namespace thunderhead::drawing
