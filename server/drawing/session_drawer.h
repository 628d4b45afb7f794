// Does the work of sessions' views, one item per turn. It draws with the source and passes the
// frames to the encoder. Long frames are drawn in pieces, by a worker. Work that needs no device is
// done in Look. Used by the render loop's thread only.
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
#include "drawing/session_reference.h"
#include "drawing/session_view.h"
#include "drawing/session_worker.h"
#include "drawing/turns.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

class SessionDrawer {
 public:
  // Limits for all sessions and own views of one identity together.
  struct Share {
    // Maximum bytes of the newest frames of these sessions and views.
    std::size_t picture_bytes = std::numeric_limits<std::size_t>::max();
    // Maximum number of pictures that the Monte Carlo reference traces for these sessions and
    // views.
    std::size_t references = std::numeric_limits<std::size_t>::max();
  };

  // All references must outlive this object.
  SessionDrawer(const PlannerTargets& targets, const FieldsAccess& fields, MeasuredSource& source,
                FrameEncoder& encoder, ReferenceTracer& tracer, LightTracer& light_tracer,
                SessionWorker& worker, const Share& share,
                const base::TimeSource& time = base::SteadyTime());

  struct PendingWork {
    std::optional<TurnClass> work;  // work that needs a turn on the device
    std::optional<session::Clock::time_point> look_again_at;
  };
  PendingWork Look(const std::shared_ptr<session::Session>& session);
  // Does the work that the last Look found for the session: all of it, or one piece.
  void TakeTurn(const std::shared_ptr<session::Session>& session);
  // Passes the frame that was drawn by the worker, if one is ready, to the encoder. `sessions` must
  // be ordered by id.
  void TakeDrawn(const std::vector<std::shared_ptr<session::Session>>& sessions);

  // Frees memory when it is scarce. Drops the frames of `sessions` without viewers. Sessions whose
  // pictures are final, or lack only the path-traced correction, release their fields and trace no
  // light for a while. If memory for another session's fields was refused, sessions whose pictures
  // are still being refined do the same.
  void YieldMemory(const std::vector<std::shared_ptr<session::Session>>& sessions);

  // Forgets which frame the worker's source drew last, because the device was replaced.
  void DeviceReplaced() { worker_.Forget(); }

  // Frees the resources of sessions without viewers and of sessions that are not in `sessions`,
  // which must be ordered by id.
  void ReleaseUnwatched(const std::vector<std::shared_ptr<session::Session>>& sessions);

 private:
  // The state kept for a session.
  struct Kept {
    std::string owner;
    SessionView view;
    SessionFields fields;
    SessionReference reference;
    SessionWork work = WaitUntil{};  // the work that the last Look found
    // The property of the scene that ShowLight could not show.
    std::optional<scene::NotShown> not_shown = std::nullopt;
    bool in_worker = false;          // the frame must be drawn by the worker
    bool gives_turn = false;         // the session's next turn goes to its frame at the worker
    int losses = 0;                  // device losses since the last frame
    bool tells = false;              // the last frame reported its error to viewers
    bool refused = false;            // memory for its fields was refused since the last frame
    std::uint64_t device_bytes = 0;  // device memory that the last frame used
    std::size_t picture_bytes = 0;   // memory of the last frame's picture
    // The revision whose frame at rest did not fit into the memory for the worker's source. The
    // render loop draws that frame in one piece.
    std::uint64_t whole_revision = 0;
  };
  // The frame that the worker draws.
  struct InWorker {
    SessionWork work;
    session::NewestScene shown;
    std::shared_ptr<const volume::HydrometeorFields> fields;
    std::uint64_t newest_revision = 0;  // newest revision of the session at the start
    TurnClass turn_class = TurnClass::kRefining;
  };
  // The session whose turn it is, and its state.
  struct Turn {
    const std::shared_ptr<session::Session>& session;
    Kept& kept;
  };

  Kept& KeptFor(const session::Session& session);
  // RESOURCE_EXHAUSTED if the owner's other frames leave no memory for this picture (CheckPicture),
  // or if the owner already has the maximum number of references (CheckReference).
  absl::Status CheckPicture(const Turn& turn, const DisplayFrame& picture) const;
  absl::Status CheckReference(const Turn& turn) const;
  void TakeRead(const Turn& turn);
  SessionWork NextWork(const Turn& turn, const session::NewestScene& newest);
  // Returns the pending work of a session whose frame the worker draws. Returns none if the session
  // no longer shows the scene of that frame.
  std::optional<PendingWork> LookInWorker(const Turn& turn, const session::NewestScene& newest);
  // Returns the work, moved to the worker if it takes too long for the render loop or if the
  // worker's source can reuse more stages than the render loop's source. The frame's quality is
  // then planned again for the stages that the worker must rerun.
  SessionWork Placed(const Turn& turn, const session::NewestScene& newest,
                     const std::optional<session::NewestScene>& drawable, SessionWork work);
  bool IsLong(const Turn& turn, const SessionWork& work) const;
  void BeginInWorker(const Turn& turn, const SessionWork& work);
  void Show(const Turn& turn, const InWorker& drawn, SessionWorker::Picture picture);

  // Each function returns the class of the turn that the work needs; absent if it needs no turn.
  PendingWork Need(const Turn& turn, const WaitUntil& work);
  PendingWork Need(const Turn& turn, const DrawFrame& work);
  PendingWork Need(const Turn& turn, const CheckSlices& work);
  PendingWork Need(const Turn& turn, const TraceLight& work);
  PendingWork Need(const Turn& turn, const ShowLight& work);
  PendingWork Need(const Turn& turn, const ShowReference& work);

  void Do(const Turn& turn, const WaitUntil& work);
  void Do(const Turn& turn, const DrawFrame& work);
  void Do(const Turn& turn, const CheckSlices& work);
  void Do(const Turn& turn, const TraceLight& work);
  void Do(const Turn& turn, const ShowLight& work);
  void Do(const Turn& turn, const ShowReference& work);

  // Draws the picture again with the light traced so far, and records what the picture does not
  // show.
  absl::Status DrawLight(const Turn& turn, const session::NewestScene& shown);
  void SendLight(const Turn& turn, const session::NewestScene& shown, DisplayFrame picture,
                 std::optional<frame::FineImage> fine);
  absl::Status ShowTraced(const Turn& turn, const session::NewestScene& shown);
  // Returns true if a viewer takes resting frames of that width, which need more than 8 bits per
  // channel.
  static bool WantsFine(session::Session& session, int width_px);
  // Returns the last picture of the render loop's source with more than 8 bits per channel, if
  // viewers need it.
  std::optional<frame::FineImage> FineOf(const Turn& turn, const DisplayFrame& picture);
  void Send(const Turn& turn, const session::NewestScene& shown, bool refined, DisplayFrame picture,
            std::optional<frame::FineImage> fine,
            std::optional<delivery::Refinement> refinement = std::nullopt);
  void Fail(const Turn& turn, std::uint64_t revision, const absl::Status& why);

  const PlannerTargets targets_;
  const FieldsAccess fields_;
  MeasuredSource& source_;
  FrameEncoder& encoder_;
  ReferenceTracer& tracer_;
  LightTracer& light_tracer_;
  SessionWorker& worker_;
  const Share share_;
  const base::TimeSource& time_;
  bool alone_ = true;                  // true if at most one session has viewers
  std::optional<InWorker> in_worker_;  // set until its outcome was taken
  std::map<std::string, Kept> kept_;   // by session id
};

}  // namespace thunderhead::drawing
