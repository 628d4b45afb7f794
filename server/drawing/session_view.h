// The next work for a session: a state machine from a scene that has just changed to its final
// picture. Returns work and is notified of its outcome; the time is an argument. Knows no threads
// and no GL.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "accuracy/estimator.h"
#include "accuracy/light_progress.h"
#include "drawing/decided_setting.h"
#include "drawing/error_measuring.h"
#include "drawing/frame_planner.h"
#include "drawing/light_tracing.h"
#include "session/sessions.h"

namespace thunderhead::drawing {

// There is no work before `time`, unless something changes.
struct WaitUntil {
  std::optional<session::Clock::time_point> time;
};
struct DrawFrame {
  session::NewestScene shown;
  FramePlan plan;
};
// Draw at full quality and with half the slices.
struct CheckSlices {
  session::NewestScene shown;
};
// Have light traced, the picture's error measured, or both.
struct TraceLight {
  session::NewestScene shown;
  bool light = true;
  bool error = false;
};
// Draw with the light traced so far, and tell the error measured so far.
struct ShowLight {
  session::NewestScene shown;
};
// Show the reference's picture so far.
struct ShowReference {
  session::NewestScene shown;
};
using SessionWork =
    std::variant<WaitUntil, DrawFrame, CheckSlices, TraceLight, ShowLight, ShowReference>;

class SessionView {
 public:
  enum class State {
    kWaitingForFields,
    kMoving,        // the scene is newer than the shown frame: draw at once, possibly coarse
    kRefining,      // the scene rests and a finer frame follows
    kChecking,      // drawn at full quality: measure error and time, and decide the setting again
    kTracingLight,  // correct the light, and measure the error, by more and more paths
    kReference,     // refined by the tracer
    kSettled,       // final, or until the scene has rested for as long as a finer frame takes
    kYielded,       // its picture stays; its fields and light were given up for others
    kFailed,        // cannot be drawn
  };

  // `costs` and `offers` must outlive it; `view` is the session's name in `costs`.
  SessionView(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
              const accuracy::Offers& offers, const std::string& view);

  // The newest scene with its decided setting. If that cannot be decided, returns an error the
  // first time and none afterwards.
  absl::StatusOr<std::optional<session::NewestScene>> Decide(const session::NewestScene& newest);

  // The work to do now. `newest` is the scene as requested; `drawable` is the decided scene whose
  // fields are available, if any: the newest, or a slightly older one.
  SessionWork Next(const session::NewestScene& newest,
                   const std::optional<session::NewestScene>& drawable,
                   session::Clock::time_point now, const std::optional<LastDrawn>& last_drawn);

  // Notifications of the outcome of work.
  void Drawn(const DrawFrame& work);
  void Checked(double discretisation_error);
  // True if the next work is to show the light traced so far, until LightShown.
  bool LightTraced(const accuracy::LightProgress& progress, session::Clock::time_point now);
  // The light stays as traced before; the picture is shown once more, with the reason.
  void LightFailed() { light_.GiveUp(true); }
  // No light is traced and no error measured for this view.
  void LightIsOthers() {
    light_.GiveUp(false);
    error_.GiveUp();
  }
  // As LightTraced.
  bool ErrorMeasured(const accuracy::ErrorProgress& progress, session::Clock::time_point now) {
    return error_.Measured(progress, now);
  }
  // No viewer wants to know the error: it is not measured.
  void ErrorIsUntold() { error_.GiveUp(); }
  void LightShown(session::Clock::time_point now) {
    light_.Shown(now);
    error_.Told(now);
  }
  void ReferenceShown(std::uint64_t revision) { planner_.GiveUp(revision); }
  // The revision is not tried again, or not before `try_again_at`.
  void Failed(std::uint64_t revision,
              std::optional<session::Clock::time_point> try_again_at = std::nullopt);
  // True once when a failed revision may be tried again; it is the next work then.
  bool TriesAgain(session::Clock::time_point now);
  // Memory is short: true if the view can do without its fields and light for a while, since the
  // picture of its scene is shown: the final one, or any if others have been refused the memory for
  // theirs.
  bool Yield(session::Clock::time_point now, bool others_lack_pictures);
  // None if `decided` is to be drawn; else the time at which to ask again, if that can be before a
  // change.
  std::optional<WaitUntil> Resting(const session::NewestScene& decided,
                                   session::Clock::time_point now);
  // Called while there is still no room for the revision: true if its picture is shown already, so
  // that nothing is missing.
  bool StaysYielded(std::uint64_t revision, session::Clock::time_point now);

  State state() const { return state_; }
  // The newest revision that was shown, or has failed.
  std::uint64_t shown_revision() const { return planner_.revision(); }
  bool LightIsTraced() const { return light_.ended(); }
  // Estimates of the error of the picture at full quality.
  accuracy::Evidence evidence() const {
    return {.discretisation_error = setting_.discretisation_error(), .measured = error_.error()};
  }

 private:
  // The inputs of a state's transition.
  struct Now {
    const session::NewestScene& newest;
    const session::NewestScene& shown;
    session::Clock::time_point time;
    const std::optional<LastDrawn>& last_drawn;
  };

  State EnteredFor(const session::NewestScene& newest,
                   const std::optional<session::NewestScene>& drawable) const;
  // Each returns work, or none after a transition to another state.
  std::optional<SessionWork> In(State state, const Now& now);
  SessionWork Move(const Now& now);
  std::optional<SessionWork> Refine(const Now& now);
  std::optional<SessionWork> Check(const Now& now);
  std::optional<SessionWork> Trace(const Now& now);
  std::optional<SessionWork> Settle(const Now& now);
  // True if the picture has too much error for the scene, and another setting is decided on.
  bool IsRefuted(const Now& now);
  // With the setting that is decided on anew for the same scene.
  SessionWork DrawAnew(const Now& now);

  const PlannerTargets targets_;
  State state_ = State::kWaitingForFields;
  FramePlanner planner_;
  DecidedSetting setting_;
  LightTracing light_;
  ErrorMeasuring error_;
  std::optional<std::uint64_t> failed_revision_;
  std::optional<session::Clock::time_point> try_again_at_;  // the failed revision
  std::optional<session::Clock::time_point>
      returns_at_;  // to refining or tracing light, after yielding
};

}  // namespace thunderhead::drawing
