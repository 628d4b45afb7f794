// A session's picture by the reference, refined by the tracer on another thread. Used by the render
// loop's thread only. Knows no GL.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "drawing/truth_tracer.h"
#include "session/sessions.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::drawing {

class SessionReference {
 public:
  // `tracer` must outlive it.
  SessionReference(TruthTracer& tracer, std::string session_id)
      : tracer_(tracer), id_(std::move(session_id)) {}

  // Ends tracing if the newest scene shows something else.
  void EndUnless(const scene::Scene& newest);

  // Begins tracing `shown`, or takes the newest picture of it. True if there is one to be shown.
  absl::StatusOr<bool> Trace(const session::NewestScene& shown,
                             const std::shared_ptr<const volume::HydrometeorFields>& fields);
  // The picture to be shown.
  const TruthPicture& TakePicture() {
    traced_->is_new = false;
    return *traced_->picture;
  }

  // True while something is traced, or was and is shown.
  bool IsTraced() const { return traced_.has_value(); }

  void Release();

 private:
  struct Traced {
    session::NewestScene shown;
    std::weak_ptr<const volume::HydrometeorFields> fields;
    std::shared_ptr<const TruthPicture> picture;  // none yet
    bool is_new = false;
  };

  TruthTracer& tracer_;
  const std::string id_;
  std::optional<Traced> traced_;
};

}  // namespace thunderhead::drawing
