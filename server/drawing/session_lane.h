// Sessions' frames that would hold up the render loop, drawn one after another in a lane: in
// pieces, between which others have their turn on the device, and until the scene changes. Used by
// the render loop's thread only.
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
  // `has_room` says whether that many bytes more may be taken on the device without asking others
  // for theirs. The lane must outlive it, and its work must have ended before this does.
  SessionLane(Lane& lane, std::function<bool(std::uint64_t bytes)> has_room)
      : lane_(lane), has_room_(std::move(has_room)) {}

  struct Request {
    std::string session_id;
    std::shared_ptr<const scene::Scene> scene;
    std::shared_ptr<const volume::HydrometeorFields> fields;
    FrameQuality quality;
    bool checked = false;  // also with half the slices
    bool fine = false;     // also with more bits a channel
  };
  struct Picture {
    DisplayFrame frame;
    std::optional<double> discretisation_error;  // of a checked one
    std::optional<frame::FineImage> fine;        // none if it cannot be had
  };

  // True if the lane holds the scene's extinction already, or has room for the `bytes` that it
  // takes in another source.
  bool HasRoomFor(const scene::Scene& scene, std::uint64_t bytes) const {
    return FirstDirty(last_drawn_, scene) > scene::Stage::kExtinction || has_room_(bytes);
  }
  // True if nothing is being drawn, and no outcome waits to be taken.
  bool IsFree() const { return outcome_ == nullptr; }
  // True while the session's frame is drawn, or its outcome waits.
  bool IsFor(const std::string& session_id) const {
    return !IsFree() && request_.session_id == session_id;
  }
  // The session of the last request.
  const std::string& For() const { return request_.session_id; }
  // The lane must be free.
  void Begin(Request request);
  // Ends the drawing at its next piece; its outcome is CANCELLED.
  void Cancel();
  // The outcome of the request, once it has ended.
  std::optional<absl::StatusOr<Picture>> Take();

  bool WantsTurn() { return lane_.WantsTurn(); }
  // Returns when the next piece is drawn.
  void GiveTurn() { lane_.GiveTurn(); }

  // The frame that the lane's source drew last, whose stages it can reuse; none after a failure.
  const std::optional<LastDrawn>& Last() const { return last_drawn_; }
  // To be called when the lane gets another source.
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
