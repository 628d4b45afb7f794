// A session's picture by the Monte Carlo reference, which a ReferenceTracer refines on another
// thread. Used by the render loop's thread only. This code does not use GL.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "drawing/reference_tracer.h"
#include "session/sessions.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::drawing {

class SessionReference {
 public:
  // `tracer` must outlive this object.
  SessionReference(ReferenceTracer& tracer, std::string session_id)
      : tracer_(tracer), id_(std::move(session_id)) {}

  // Stops tracing if the newest scene would give another picture.
  void EndUnless(const scene::Scene& newest);

  // Begins tracing `shown`, or takes the newest picture from the tracer. Returns true if there is a
  // new picture to show, or the error with which tracing could not begin or has ended.
  absl::StatusOr<bool> Trace(const session::NewestScene& shown,
                             const std::shared_ptr<const volume::HydrometeorFields>& fields);
  // Returns the picture to show, and marks it as taken.
  const ReferencePicture& TakePicture() {
    traced_->is_new = false;
    return *traced_->picture;
  }

  // Returns true while the reference is being traced or its picture is kept.
  bool IsTraced() const { return traced_.has_value(); }

  void Release();

 private:
  struct Traced {
    session::NewestScene shown;
    std::weak_ptr<const volume::HydrometeorFields> fields;
    std::shared_ptr<const ReferencePicture> picture;  // null until there is one
    bool is_new = false;
  };

  ReferenceTracer& tracer_;
  const std::string id_;
  std::optional<Traced> traced_;
};

}  // namespace thunderhead::drawing
