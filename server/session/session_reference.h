// A session's picture by the reference, refined by the tracer beside the render loop. Used by the
// render loop's thread only. Knows no GL.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "session/sessions.h"
#include "session/truth_tracer.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::session {

class SessionReference {
 public:
  // `tracer` must outlive it.
  SessionReference(TruthTracer& tracer, std::string session_id)
      : tracer_(tracer), id_(std::move(session_id)) {}

  // Ends what is traced if the newest scene shows something else.
  void EndUnless(const scene::Scene& newest);

  // Begins `shown`, or takes what was traced meanwhile. True if there is something in picture()
  // that its viewers have not seen.
  absl::StatusOr<bool> Trace(const NewestScene& shown,
                             const std::shared_ptr<const volume::HydrometeorFields>& fields);
  const TruthPicture& picture() const { return *traced_->picture; }

  void LetGo();

 private:
  struct Traced {
    NewestScene shown;
    std::shared_ptr<const TruthPicture> picture;  // none yet
  };

  TruthTracer& tracer_;
  const std::string id_;
  std::optional<Traced> traced_;
};

}  // namespace thunderhead::session
