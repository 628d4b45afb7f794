// Draws the pictures of an ImageQueue. A picture that awaits traced light takes many turns, with
// other pictures and sessions in between. Used by the render loop's thread only.
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
  // Traces a step. True if the picture needs more paths, for the requested error if there is one.
  absl::StatusOr<bool> Trace(const ImageJob& job);

  ImageQueue& queue_;
  MeasuredSource& source_;
};

}  // namespace thunderhead::session
