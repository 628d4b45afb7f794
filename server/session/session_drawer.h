// Does the work that sessions' views ask for, one item in each turn: draws with the source and
// passes frames to the encoder. What needs no device it does while it looks for work. Used by the
// render loop's thread only.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "session/frame_encoder.h"
#include "session/light_tracer.h"
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
                FrameEncoder& encoder, TruthTracer& tracer, LightTracer& light_tracer);

  struct Wish {
    std::optional<TurnClass> work;  // to be done in a turn
    std::optional<Clock::time_point> look_again_at;
  };
  Wish Look(const std::shared_ptr<Session>& session);
  // Does the work that Look found for the session last.
  void TakeTurn(const std::shared_ptr<Session>& session);

  // Memory is short: sessions whose pictures are shown leave their fields to others, and have no
  // light traced, for a while.
  void YieldMemory();

  // Frees the resources of sessions without viewers and of those not in `sessions`, which are in
  // order of id.
  void ReleaseUnwatched(const std::vector<std::shared_ptr<Session>>& sessions);

 private:
  // The state kept for a session.
  struct Kept {
    SessionView view;
    SessionFields fields;
    SessionReference reference;
    SessionWork work = WaitUntil{};  // found last
    // Of that work, if it is to show traced light.
    std::optional<scene::NotShown> not_shown = std::nullopt;
    int losses = 0;      // of the device, since the last frame
    bool tells = false;  // the last frame said its error
  };
  // A session whose turn it is.
  struct Turn {
    const std::shared_ptr<Session>& session;
    Kept& kept;
  };

  Kept& KeptFor(const std::string& session_id);
  void TakeRead(const Turn& turn);
  SessionWork NextWork(const Turn& turn, const NewestScene& newest);

  // Each tells in which class the work is, if it needs a turn.
  Wish Need(const Turn& turn, const WaitUntil& work);
  Wish Need(const Turn& turn, const DrawFrame& work);
  Wish Need(const Turn& turn, const CheckSlices& work);
  Wish Need(const Turn& turn, const TraceLight& work);
  Wish Need(const Turn& turn, const ShowLight& work);
  Wish Need(const Turn& turn, const ShowReference& work);

  void Do(const Turn& turn, const WaitUntil& work);
  void Do(const Turn& turn, const DrawFrame& work);
  void Do(const Turn& turn, const CheckSlices& work);
  void Do(const Turn& turn, const TraceLight& work);
  void Do(const Turn& turn, const ShowLight& work);
  void Do(const Turn& turn, const ShowReference& work);

  // The picture once more, with the light traced so far; it says what is missing.
  absl::Status DrawLight(const Turn& turn, const NewestScene& shown);
  absl::Status ShowTraced(const Turn& turn, const NewestScene& shown);
  // Of the picture that the source has just given.
  void Send(const Turn& turn, const NewestScene& shown, bool refined, DisplayFrame picture,
            std::optional<Refinement> refinement = std::nullopt);
  void Fail(const Turn& turn, std::uint64_t revision, const absl::Status& why);

  const PlannerTargets targets_;
  const FieldsAccess fields_;
  MeasuredSource& source_;
  FrameEncoder& encoder_;
  TruthTracer& tracer_;
  LightTracer& light_tracer_;
  std::map<std::string, Kept> kept_;  // by session id
};

}  // namespace thunderhead::session
