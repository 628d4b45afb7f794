// Draws the pictures of an ImageQueue, one turn at a time: a picture that awaits traced light takes
// many, and others have theirs in between. Used by the render loop's thread only.
#pragma once

#include "absl/status/statusor.h"
#include "session/image_queue.h"
#include "session/measured_source.h"
#include "session/turns.h"

namespace thunderhead::session {

class ImageDrawer {
 public:
  // Both must outlive it.
  ImageDrawer(ImageQueue& queue, MeasuredSource& source) : queue_(queue), source_(source) {}

  TurnOutcome TakeTurn();

 private:
  // True if the picture, its setting decided, awaits more paths: enough for the error that it asks
  // for, if it does.
  absl::StatusOr<bool> Trace(const ImageJob& job);

  ImageQueue& queue_;
  MeasuredSource& source_;
};

}  // namespace thunderhead::session
