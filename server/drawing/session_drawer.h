// Does the work that sessions' views ask for, one item in each turn: draws with the source and
// passes frames to the encoder; what would take long is drawn in pieces, in a lane. What needs no
// device it does while it looks for work. Used by the render loop's thread only.
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/time_source.h"
#include "drawing/frame_encoder.h"
#include "drawing/light_tracer.h"
#include "drawing/measured_source.h"
#include "drawing/session_fields.h"
#include "drawing/session_lane.h"
#include "drawing/session_reference.h"
#include "drawing/session_view.h"
#include "drawing/turns.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

class SessionDrawer {
 public:
  // How much the sessions and own views of one identity may hold.
  struct Share {
    std::size_t picture_bytes = std::numeric_limits<std::size_t>::max();  // their newest frames
    std::size_t references = std::numeric_limits<std::size_t>::max();     // that are traced
  };

  // All references must outlive it.
  SessionDrawer(const PlannerTargets& targets, const FieldsAccess& fields, MeasuredSource& source,
                FrameEncoder& encoder, TruthTracer& tracer, LightTracer& light_tracer,
                SessionLane& lane, const Share& share,
                const base::TimeSource& time = base::SteadyTime());

  struct Wish {
    std::optional<TurnClass> work;  // to be done in a turn
    std::optional<session::Clock::time_point> look_again_at;
  };
  Wish Look(const std::shared_ptr<session::Session>& session);
  // Does the work that Look found for the session last: whole, or a piece of it.
  void TakeTurn(const std::shared_ptr<session::Session>& session);
  // Sends the frame that was drawn in the lane, if one is ready. `sessions` are in order of id.
  void TakeDrawn(const std::vector<std::shared_ptr<session::Session>>& sessions);

  // Memory is short: frames of `sessions` that nobody watches are given up; sessions whose final
  // pictures are shown leave their fields to others, and have
  // no light traced, for a while; those whose pictures become finer do so too where a session has
  // been refused the fields for its own.
  void YieldMemory(const std::vector<std::shared_ptr<session::Session>>& sessions);

  // The device is another: what the sources kept is gone.
  void DeviceReplaced() { lane_.Forget(); }

  // Frees the resources of sessions without viewers and of those not in `sessions`, which are in
  // order of id.
  void ReleaseUnwatched(const std::vector<std::shared_ptr<session::Session>>& sessions);

 private:
  // The state kept for a session.
  struct Kept {
    std::string owner;
    SessionView view;
    SessionFields fields;
    SessionReference reference;
    SessionWork work = WaitUntil{};  // found last
    // Of that work, if it is to show traced light.
    std::optional<scene::NotShown> not_shown = std::nullopt;
    bool in_lane = false;            // where that work is to be done
    bool gives_turn = false;         // to its frame that is in the lane; there is no other work
    int losses = 0;                  // of the device, since the last frame
    bool tells = false;              // the last frame said its error
    bool refused = false;            // memory for its fields, since the last frame
    std::uint64_t device_bytes = 0;  // of the last frame
    std::size_t picture_bytes = 0;   // of it as well
    // The revision whose frame at rest had no room in the lane; it is drawn whole.
    std::uint64_t whole_revision = 0;
  };
  // The frame in the lane.
  struct InLane {
    SessionWork work;
    session::NewestScene shown;
    std::shared_ptr<const volume::HydrometeorFields> fields;
    std::uint64_t newest_revision = 0;  // of the session when it was begun
    TurnClass turn_class = TurnClass::kRefining;
  };
  // A session whose turn it is.
  struct Turn {
    const std::shared_ptr<session::Session>& session;
    Kept& kept;
  };

  Kept& KeptFor(const session::Session& session);
  // RESOURCE_EXHAUSTED if its owner's other frames leave no room for this picture, or other
  // references none for one.
  absl::Status CheckPicture(const Turn& turn, const DisplayFrame& picture) const;
  absl::Status CheckReference(const Turn& turn) const;
  void TakeRead(const Turn& turn);
  SessionWork NextWork(const Turn& turn, const session::NewestScene& newest);
  // The wish of a session whose frame is in the lane; none if that is not what it shows any more.
  std::optional<Wish> LookInLane(const Turn& turn, const session::NewestScene& newest);
  // The work with the stages that the lane's source can reuse, where it can reuse more, or where it
  // is too long for the render loop's own turn.
  SessionWork Placed(const Turn& turn, const session::NewestScene& newest,
                     const std::optional<session::NewestScene>& drawable, SessionWork work);
  bool IsLong(const Turn& turn, const SessionWork& work) const;
  void BeginInLane(const Turn& turn, const SessionWork& work);
  void Show(const Turn& turn, const InLane& drawn, SessionLane::Picture picture);

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
  absl::Status DrawLight(const Turn& turn, const session::NewestScene& shown);
  void SendLight(const Turn& turn, const session::NewestScene& shown, DisplayFrame picture,
                 std::optional<frame::FineImage> fine);
  absl::Status ShowTraced(const Turn& turn, const session::NewestScene& shown);
  // True if a refined frame of that width is wanted with more bits.
  static bool WantsFine(session::Session& session, int width_px);
  // The same of the picture that the render loop's source has just given, if it is wanted.
  std::optional<frame::FineImage> FineOf(const Turn& turn, const DisplayFrame& picture);
  void Send(const Turn& turn, const session::NewestScene& shown, bool refined, DisplayFrame picture,
            std::optional<frame::FineImage> fine,
            std::optional<delivery::Refinement> refinement = std::nullopt);
  void Fail(const Turn& turn, std::uint64_t revision, const absl::Status& why);

  const PlannerTargets targets_;
  const FieldsAccess fields_;
  MeasuredSource& source_;
  FrameEncoder& encoder_;
  TruthTracer& tracer_;
  LightTracer& light_tracer_;
  SessionLane& lane_;
  const Share share_;
  const base::TimeSource& time_;
  bool alone_ = true;                 // at most one session is watched
  std::optional<InLane> in_lane_;     // the lane's, until its outcome was taken
  std::map<std::string, Kept> kept_;  // by session id
};

}  // namespace thunderhead::drawing
