// Does the work that sessions' views ask for, one item in each turn: draws with the source and
// passes frames to the encoder. Used by the render loop's thread only.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "session/frame_encoder.h"
#include "session/measured_source.h"
#include "session/session_fields.h"
#include "session/session_reference.h"
#include "session/session_view.h"
#include "session/sessions.h"
#include "session/turns.h"

namespace thunderhead::session {

class SessionDrawer {
 public:
  // All references must outlive it.
  SessionDrawer(const PlannerTargets& targets, const FieldsAccess& fields, MeasuredSource& source,
                FrameEncoder& encoder, TruthTracer& tracer);

  TurnOutcome TakeTurn(const std::shared_ptr<Session>& session, TurnKind kind);

  // Frees the resources of sessions without viewers and of those not in `sessions`, which are in
  // order of id.
  void ReleaseUnwatched(const std::vector<std::shared_ptr<Session>>& sessions);

 private:
  // The state kept for a session.
  struct Kept {
    SessionView view;
    SessionFields fields;
    SessionReference reference;
  };
  // A session whose turn it is.
  struct Turn {
    const std::shared_ptr<Session>& session;
    Kept& kept;
    TurnKind kind;
  };

  Kept& KeptFor(const std::string& session_id);
  void TakeRead(const Turn& turn);
  SessionWork NextWork(const Turn& turn, const NewestScene& newest);

  TurnOutcome Do(const Turn& turn, const WaitUntil& work);
  TurnOutcome Do(const Turn& turn, const DrawFrame& work);
  TurnOutcome Do(const Turn& turn, const CheckSlices& work);
  TurnOutcome Do(const Turn& turn, const TraceLight& work);
  TurnOutcome Do(const Turn& turn, const ShowReference& work);

  // The picture once more, with the light traced so far; it says that `not_shown` is missing.
  absl::Status ShowLight(const Turn& turn, const NewestScene& shown,
                         const std::optional<scene::NotShown>& not_shown);
  absl::StatusOr<bool> ShowTraced(const Turn& turn, const NewestScene& shown);
  // Of the picture that the source has just given.
  void Send(const Turn& turn, const NewestScene& shown, bool refined, DisplayFrame picture,
            std::optional<Refinement> refinement = std::nullopt);
  void Fail(const Turn& turn, std::uint64_t revision, const absl::Status& why);

  const PlannerTargets targets_;
  const FieldsAccess fields_;
  MeasuredSource& source_;
  FrameEncoder& encoder_;
  TruthTracer& tracer_;
  std::map<std::string, Kept> kept_;  // by session id
};

}  // namespace thunderhead::session
