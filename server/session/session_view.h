// What is to be done next for a session: a state machine from a scene that has just changed, to a
// picture of which nothing finer is to come. Asks for work, and is told of its outcome; the time is
// given. Knows no threads and no GL.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "accuracy/light_progress.h"
#include "session/decided_setting.h"
#include "session/frame_planner.h"
#include "session/light_tracing.h"
#include "session/sessions.h"

namespace thunderhead::session {

// Nothing, before that time, unless something changes.
struct WaitUntil {
  std::optional<Clock::time_point> time;
};
struct DrawFrame {
  NewestScene shown;
  FramePlan plan;
};
// At full quality and with half the slices.
struct CheckSlices {
  NewestScene shown;
};
// One step.
struct TraceLight {
  NewestScene shown;
};
// The reference's picture, as far as it has come.
struct ShowReference {
  NewestScene shown;
};
using SessionWork = std::variant<WaitUntil, DrawFrame, CheckSlices, TraceLight, ShowReference>;

class SessionView {
 public:
  enum class State {
    kWaitingForFields,
    kMoving,        // the scene is newer than what is shown: a frame at once, maybe coarse
    kRefining,      // it rests, and a finer frame is to come
    kChecking,      // drawn in full: its error and time are found, and the setting decided again
    kTracingLight,  // its light is corrected by more and more paths
    kReference,     // the tracer refines it beside the loop
    kSettled,       // nothing finer is to come
    kFailed,        // it cannot be drawn
  };

  // `costs` and `offers` must outlive it; `view` is what the session is called in `costs`.
  SessionView(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
              const accuracy::Offers& offers, const std::string& view);

  // The newest scene as it is to be drawn; none if its setting could not be decided, which is an
  // error the first time.
  absl::StatusOr<std::optional<NewestScene>> Decide(const NewestScene& newest);

  // The work to do now. `newest` is the scene as it was asked for; `drawable` is the decided scene
  // whose fields are at hand, if any: the newest, or one shortly before.
  SessionWork Next(const NewestScene& newest, const std::optional<NewestScene>& drawable,
                   Clock::time_point now, const std::optional<LastDrawn>& last_drawn);

  // Outcomes of work.
  void Drawn(const DrawFrame& work);
  void Checked(double discretisation_error);
  // True if the picture is to be drawn with the light traced so far, and LightShown called.
  bool LightTraced(const accuracy::LightProgress& progress, Clock::time_point now);
  // The picture stays, with the light traced before.
  void LightFailed() { light_.GiveUp(); }
  void LightShown(Clock::time_point now) { light_.Shown(now); }
  void ReferenceShown(std::uint64_t revision) { planner_.GiveUp(revision); }
  // It is not tried again for that revision.
  void Failed(std::uint64_t revision);

  State state() const { return state_; }
  // The newest revision that was shown, or could not be.
  std::uint64_t shown_revision() const { return planner_.revision(); }
  bool LightIsTraced() const { return light_.ended(); }
  const std::optional<double>& discretisation_error() const {
    return setting_.discretisation_error();
  }

 private:
  // What a state's transition looks at.
  struct Now {
    const NewestScene& newest;
    const NewestScene& shown;
    Clock::time_point time;
    const std::optional<LastDrawn>& last_drawn;
  };

  State EnteredFor(const NewestScene& newest, const std::optional<NewestScene>& drawable) const;
  // Each returns work, or none if it has moved on to another state.
  std::optional<SessionWork> In(State state, const Now& now);
  SessionWork Move(const Now& now);
  std::optional<SessionWork> Refine(const Now& now);
  std::optional<SessionWork> Check(const Now& now);
  std::optional<SessionWork> Trace(const Now& now);
  Clock::time_point SettledAt(const NewestScene& scene) const;

  const PlannerTargets targets_;
  State state_ = State::kWaitingForFields;
  FramePlanner planner_;
  DecidedSetting setting_;
  LightTracing light_;
  std::optional<std::uint64_t> failed_revision_;
};

}  // namespace thunderhead::session
