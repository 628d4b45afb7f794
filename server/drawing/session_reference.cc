#include "drawing/session_reference.h"

#include <utility>
#include <variant>

#include "base/status.h"

namespace thunderhead::drawing {

void SessionReference::EndUnless(const scene::Scene& newest) {
  if (!traced_.has_value()) return;
  if (!scene::IsTraced(newest.rendering.technique)) {
    Release();
  } else if (scene::FirstDirtyStage(*traced_->shown.scene, newest) < scene::Stage::kTone) {
    tracer_.Stop(id_);
    traced_.reset();
  }
}

absl::StatusOr<bool> SessionReference::Trace(
    const session::NewestScene& shown,
    const std::shared_ptr<const volume::HydrometeorFields>& fields) {
  // A storm's fields change when its file is replaced, so the picture is traced anew.
  if (traced_.has_value() && traced_->fields.lock() != fields) {
    tracer_.Stop(id_);
    traced_.reset();
  }
  if (!traced_.has_value()) {
    traced_ = Traced{shown, fields, nullptr, false};
    THUNDERHEAD_RETURN_IF_ERROR(tracer_.Trace(id_, shown.scene, fields));
    return false;
  }
  // The new scene may have another exposure, so the same picture must be shown again.
  if (traced_->picture != nullptr && shown.revision > traced_->shown.revision) {
    traced_->is_new = true;
  }
  traced_->shown = shown;
  if (auto taken = tracer_.Take(id_); taken.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(traced_->picture, *std::move(taken));
    traced_->is_new = true;
  }
  return traced_->is_new;
}

void SessionReference::Release() {
  tracer_.Forget(id_);
  traced_.reset();
}

}  // namespace thunderhead::drawing
