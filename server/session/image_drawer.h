// Draws the pictures of an ImageQueue. A picture that awaits traced light takes many turns, with
// other pictures and sessions in between. What a picture's setting needs first, such as a fit of
// metaballs, is made on a thread of its own. Used by the render loop's thread only.
#pragma once

#include <functional>
#include <memory>

#include "absl/status/statusor.h"
#include "base/executor.h"
#include "session/image_queue.h"
#include "session/measured_source.h"
#include "session/turns.h"

namespace thunderhead::session {

class ImageDrawer {
 public:
  // Both references must outlive it. `preparation` is null if no scene needs any; `on_prepared` is
  // called on the thread that prepares.
  ImageDrawer(ImageQueue& queue, MeasuredSource& source, std::shared_ptr<Preparation> preparation,
              std::function<void()> on_prepared);

  // Works on the first picture that need not wait for its preparation, or for others' light.
  TurnOutcome TakeTurn();

 private:
  enum class Next { kDraw, kTraceOn, kWaitForPreparation, kWaitForOthersLight };

  // Does what comes before drawing, or a step of it.
  absl::StatusOr<Next> Advance(ImageJob& job);
  // True once the picture, its setting decided, is prepared.
  absl::StatusOr<bool> Prepare(ImageJob& job);
  // Traces a step. True if the picture needs more paths, for the requested error if there is one.
  absl::StatusOr<bool> Trace(ImageJob& job);
  absl::StatusOr<DisplayFrame> Draw(const ImageJob& job);

  ImageQueue& queue_;
  MeasuredSource& source_;
  const std::shared_ptr<Preparation> preparation_;
  const std::function<void()> on_prepared_;
  base::Executor preparer_;
};

}  // namespace thunderhead::session
