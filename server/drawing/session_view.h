// The next work for a session: a state machine that leads from a changed scene to its final
// picture. It returns work and is told the outcome by calls; the time is an argument. This code
// uses neither threads nor GL.
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

// There is nothing to do before `time`, unless something changes.
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
// Requests that light be traced, the picture's error be measured, or both.
struct TraceLight {
  session::NewestScene shown;
  bool light = true;
  bool error = false;
};
// Draws with the light traced so far and reports the error measured so far.
struct ShowLight {
  session::NewestScene shown;
};
// Shows the current picture of the Monte Carlo reference.
struct ShowReference {
  session::NewestScene shown;
};
using SessionWork =
    std::variant<WaitUntil, DrawFrame, CheckSlices, TraceLight, ShowLight, ShowReference>;

class SessionView {
 public:
  enum class State {
    kWaitingForFields,
    kMoving,    // the scene is newer than the shown frame: it is drawn at once, possibly coarse
    kRefining,  // the scene is at rest and a finer frame follows
    // Drawn at full quality: its error and time are measured, and the setting is decided again.
    kChecking,
    kTracingLight,  // more and more paths correct the light and measure the error
    kReference,     // the Monte Carlo reference refines the picture
    // The picture is final, or waits until the scene has rested as long as the next finer frame
    // takes.
    kSettled,
    // The picture stays; its fields and light were released to free memory for other sessions.
    kYielded,
    kFailed,  // the scene cannot be drawn
  };

  // `costs` and `offers` must outlive the view. `view` is the session's name in `costs`.
  SessionView(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
              const accuracy::Offers& offers, const std::string& view);

  // Returns the newest scene with its setting decided. If no setting can be decided, returns the
  // error the first time and none afterwards.
  absl::StatusOr<std::optional<session::NewestScene>> Decide(const session::NewestScene& newest);

  // Returns the work to do now. `newest` is the scene as requested. `drawable` is the decided scene
  // whose fields are available, if any. It is the newest scene or a slightly older one.
  SessionWork Next(const session::NewestScene& newest,
                   const std::optional<session::NewestScene>& drawable,
                   session::Clock::time_point now, const std::optional<LastDrawn>& last_drawn);

  // The following functions report the outcome of work.
  void Drawn(const DrawFrame& work);
  void Checked(double discretisation_error);
  // Returns true if the light traced so far should be shown next. It stays true until LightShown is
  // called.
  bool LightTraced(const accuracy::LightProgress& progress, session::Clock::time_point now);
  // Records that tracing failed. The light traced before is kept, and the picture is shown once
  // more with the reason.
  void LightFailed() { light_.GiveUp(true); }
  // Records that this view traces no light and measures no error, because another view (its
  // session's) does.
  void LightIsOthers() {
    light_.GiveUp(false);
    error_.GiveUp();
  }
  // Returns true if the error measured so far should be reported next, as for LightTraced.
  bool ErrorMeasured(const accuracy::ErrorProgress& progress, session::Clock::time_point now) {
    return error_.Measured(progress, now);
  }
  // Records that no error is measured, because none is reported to viewers.
  void ErrorIsUntold() { error_.GiveUp(); }
  void LightShown(session::Clock::time_point now) {
    light_.Shown(now);
    error_.Told(now);
  }
  void ReferenceShown(std::uint64_t revision) { planner_.GiveUp(revision); }
  // Records that the revision cannot be drawn. It is retried at `try_again_at`, or never if that is
  // absent.
  void Failed(std::uint64_t revision,
              std::optional<session::Clock::time_point> try_again_at = std::nullopt);
  // Returns true once when the failed revision may be retried. The retry is then the next work.
  bool TriesAgain(session::Clock::time_point now);
  // Called when memory is scarce. Returns true if the view now releases its fields and light for a
  // while. It does so if its picture is final, or lacks only the path-traced correction. If memory
  // for the fields of other sessions was refused (`others_lack_pictures`), any shown picture of the
  // scene suffices.
  bool Yield(session::Clock::time_point now, bool others_lack_pictures);
  // If the view stays yielded, returns the time at which to ask again, or WaitUntil without a time
  // if only a change of the scene ends this state. Returns none if `decided` must be drawn.
  std::optional<WaitUntil> Resting(const session::NewestScene& decided,
                                   session::Clock::time_point now);
  // Called while memory for the revision is still missing. Returns true if the revision's picture
  // is already shown, so that the view can stay yielded.
  bool StaysYielded(std::uint64_t revision, session::Clock::time_point now);

  State state() const { return state_; }
  // Returns the newest revision that was shown or has failed.
  std::uint64_t shown_revision() const { return planner_.revision(); }
  bool LightIsTraced() const { return light_.ended(); }
  // Returns what is known about the error of the picture at full quality.
  accuracy::Evidence evidence() const {
    return {.discretisation_error = setting_.discretisation_error(), .measured = error_.error()};
  }

 private:
  // The inputs of a state transition.
  struct Now {
    const session::NewestScene& newest;
    const session::NewestScene& shown;
    session::Clock::time_point time;
    const std::optional<LastDrawn>& last_drawn;
  };

  State EnteredFor(const session::NewestScene& newest,
                   const std::optional<session::NewestScene>& drawable) const;
  // Each function returns the work of its state, or none after a transition to another state.
  std::optional<SessionWork> In(State state, const Now& now);
  SessionWork Move(const Now& now);
  std::optional<SessionWork> Refine(const Now& now);
  std::optional<SessionWork> Check(const Now& now);
  std::optional<SessionWork> Trace(const Now& now);
  std::optional<SessionWork> Settle(const Now& now);
  // Returns true if the picture's error is too large for the scene and another setting was decided.
  bool IsRefuted(const Now& now);
  // Returns the work that draws the same scene with the newly decided setting.
  SessionWork DrawAnew(const Now& now);

  const PlannerTargets targets_;
  State state_ = State::kWaitingForFields;
  FramePlanner planner_;
  DecidedSetting setting_;
  LightTracing light_;
  ErrorMeasuring error_;
  std::optional<std::uint64_t> failed_revision_;
  // Time at which to retry the failed revision.
  std::optional<session::Clock::time_point> try_again_at_;
  std::optional<session::Clock::time_point>
      returns_at_;  // time at which to resume refining or tracing light after yielding
};

}  // namespace thunderhead::drawing
