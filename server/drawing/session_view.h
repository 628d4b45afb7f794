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

// Nothing to do before `time`, unless something changes.
struct WaitUntil {
  std::optional<session::Clock::time_point> time;
};
struct DrawFrame {
  session::NewestScene shown;
  FramePlan plan;
};
// Draws at full quality and with half the slices.
struct CheckSlices {
  session::NewestScene shown;
};
// Requests light to be traced, the picture's error to be measured, or both.
struct TraceLight {
  session::NewestScene shown;
  bool light = true;
  bool error = false;
};
// Draws with the light traced so far and reports the error measured so far.
struct ShowLight {
  session::NewestScene shown;
};
// Shows the reference's current picture.
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
    kRefining,      // the scene is at rest and a finer frame follows
    kChecking,      // drawn at full quality: measure error and time, and decide the setting again
    kTracingLight,  // correct the light and measure the error with more and more paths
    kReference,     // refined by the tracer
    kSettled,       // final, or until the scene has rested for as long as a finer frame takes
    kYielded,       // its picture stays; its fields and light were released for other sessions
    kFailed,        // cannot be drawn
  };

  // `costs` and `offers` must outlive it. `view` is the session's name in `costs`.
  SessionView(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
              const accuracy::Offers& offers, const std::string& view);

  // Returns the newest scene with its decided setting. If the setting cannot be decided, returns an
  // error the first time and none afterwards.
  absl::StatusOr<std::optional<session::NewestScene>> Decide(const session::NewestScene& newest);

  // Returns the work to do now. `newest` is the scene as requested. `drawable` is the decided scene
  // whose fields are available, if any: the newest, or a slightly older one.
  SessionWork Next(const session::NewestScene& newest,
                   const std::optional<session::NewestScene>& drawable,
                   session::Clock::time_point now, const std::optional<LastDrawn>& last_drawn);

  // The following functions report the outcome of work.
  void Drawn(const DrawFrame& work);
  void Checked(double discretisation_error);
  // Returns true if the next work is to show the light traced so far, until LightShown is called.
  bool LightTraced(const accuracy::LightProgress& progress, session::Clock::time_point now);
  // Keeps the light traced before. The picture is shown once more, with the reason.
  void LightFailed() { light_.GiveUp(true); }
  // Records that this view traces no light and measures no error.
  void LightIsOthers() {
    light_.GiveUp(false);
    error_.GiveUp();
  }
  // Works like LightTraced.
  bool ErrorMeasured(const accuracy::ErrorProgress& progress, session::Clock::time_point now) {
    return error_.Measured(progress, now);
  }
  // Records that no error is reported to viewers, so that it is not measured.
  void ErrorIsUntold() { error_.GiveUp(); }
  void LightShown(session::Clock::time_point now) {
    light_.Shown(now);
    error_.Told(now);
  }
  void ReferenceShown(std::uint64_t revision) { planner_.GiveUp(revision); }
  // Records that the revision cannot be drawn. It is not retried, or not before `try_again_at`.
  void Failed(std::uint64_t revision,
              std::optional<session::Clock::time_point> try_again_at = std::nullopt);
  // Returns true once when a failed revision may be retried, which is then the next work.
  bool TriesAgain(session::Clock::time_point now);
  // Called when memory is scarce. Returns true if the view releases its fields and light for a
  // while. It can do so if its final picture is shown. If the fields of other sessions were
  // refused, any picture of the scene suffices.
  bool Yield(session::Clock::time_point now, bool others_lack_pictures);
  // Returns none if `decided` must be drawn. Otherwise returns the time at which to ask again, if
  // that can be before a change.
  std::optional<WaitUntil> Resting(const session::NewestScene& decided,
                                   session::Clock::time_point now);
  // Called while there is still no memory for the revision. Returns true if its picture is already
  // shown, so that nothing is missing.
  bool StaysYielded(std::uint64_t revision, session::Clock::time_point now);

  State state() const { return state_; }
  // The newest revision that was shown or has failed.
  std::uint64_t shown_revision() const { return planner_.revision(); }
  bool LightIsTraced() const { return light_.ended(); }
  // Returns the estimates of the error of the picture at full quality.
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
  // Each function returns work, or none after a transition to another state.
  std::optional<SessionWork> In(State state, const Now& now);
  SessionWork Move(const Now& now);
  std::optional<SessionWork> Refine(const Now& now);
  std::optional<SessionWork> Check(const Now& now);
  std::optional<SessionWork> Trace(const Now& now);
  std::optional<SessionWork> Settle(const Now& now);
  // Returns true if the picture's error is too large for the scene and another setting was decided.
  bool IsRefuted(const Now& now);
  // Draws with the newly decided setting for the same scene.
  SessionWork DrawAnew(const Now& now);

  const PlannerTargets targets_;
  State state_ = State::kWaitingForFields;
  FramePlanner planner_;
  DecidedSetting setting_;
  LightTracing light_;
  ErrorMeasuring error_;
  std::optional<std::uint64_t> failed_revision_;
  std::optional<session::Clock::time_point> try_again_at_;  // time to retry the failed revision
  std::optional<session::Clock::time_point>
      returns_at_;  // time to return to refining or tracing light after yielding
};

}  // namespace thunderhead::drawing
