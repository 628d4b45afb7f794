#include "drawing/session_worker.h"

#include <utility>

#include "base/guarded.h"
#include "base/status.h"

namespace thunderhead::drawing {
namespace {

absl::StatusOr<SessionWorker::Picture> Drawn(FrameSource& source,
                                             const SessionWorker::Request& request) {
  SessionWorker::Picture picture;
  if (request.checked) {
    THUNDERHEAD_ASSIGN_OR_RETURN(CheckedFrame checked,
                                 source.DrawChecked(*request.scene, request.fields));
    picture.frame = std::move(checked.frame);
    picture.discretisation_error = checked.discretisation_error;
  } else {
    THUNDERHEAD_ASSIGN_OR_RETURN(picture.frame,
                                 source.Draw(*request.scene, request.fields, request.quality));
  }
  if (request.fine) {
    if (auto fine = source.Fine(); fine.ok()) picture.fine = *std::move(fine);
  }
  return picture;
}

}  // namespace

void SessionWorker::Begin(Request request) {
  THUNDERHEAD_CHECK(IsFree(), "a frame of a session is being drawn");
  request_ = std::move(request);
  last_drawn_.reset();
  outcome_ = std::make_shared<Outcome>();
  cancelled_ = std::make_shared<std::atomic<bool>>(false);
  worker_.Begin(
      [outcome = outcome_, request = request_](const absl::StatusOr<FrameSource*>& source) {
        auto picture = base::Guarded([&]() -> absl::StatusOr<Picture> {
          if (!source.ok()) return source.status();
          return Drawn(**source, request);
        });
        const std::lock_guard lock(outcome->mutex);
        outcome->picture = std::move(picture);
      },
      {.cancelled = cancelled_});
}

void SessionWorker::Cancel() {
  if (!IsFree()) *cancelled_ = true;
}

std::optional<absl::StatusOr<SessionWorker::Picture>> SessionWorker::Take() {
  if (IsFree() || !worker_.IsIdle()) return std::nullopt;
  const std::shared_ptr<Outcome> outcome = std::exchange(outcome_, nullptr);
  const std::lock_guard lock(outcome->mutex);
  if (outcome->picture->ok()) {
    last_drawn_ = LastDrawn{*request_.scene, request_.quality, request_.fields};
  }
  request_.fields.reset();
  return std::move(outcome->picture);
}

}  // namespace thunderhead::drawing
