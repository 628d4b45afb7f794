#include "drawing/session_view.h"

#include <chrono>

#include "base/status.h"

namespace thunderhead::drawing {
namespace {

// A view stays yielded this long, so that the sessions that wait for memory can show their
// pictures.
constexpr std::chrono::seconds kYieldedFor{30};

}  // namespace

SessionView::SessionView(const PlannerTargets& targets, const accuracy::MachineCosts& costs,
                         const accuracy::Offers& offers, const std::string& view)
    : targets_(targets), planner_(targets, costs, view), setting_(offers) {}

absl::StatusOr<std::optional<session::NewestScene>> SessionView::Decide(
    const session::NewestScene& newest) {
  auto decided = setting_.Decide(newest);
  if (!decided.ok()) Failed(newest.revision);
  return decided;
}

SessionWork SessionView::Next(const session::NewestScene& newest,
                              const std::optional<session::NewestScene>& drawable,
                              session::Clock::time_point now,
                              const std::optional<LastDrawn>& last_drawn) {
  state_ = EnteredFor(newest, drawable);
  if (state_ == State::kFailed) return WaitUntil{try_again_at_};
  if (!drawable.has_value()) return WaitUntil{};
  std::optional<SessionWork> work;
  while (!work.has_value()) work = In(state_, {newest, *drawable, now, last_drawn});
  return *work;
}

SessionView::State SessionView::EnteredFor(
    const session::NewestScene& newest, const std::optional<session::NewestScene>& drawable) const {
  const session::NewestScene& scene = drawable.has_value() ? *drawable : newest;
  if (scene.revision == failed_revision_) return State::kFailed;
  if (!drawable.has_value()) return State::kWaitingForFields;
  const scene::Technique& technique = scene.scene->rendering.technique;
  if (scene::IsTraced(technique)) return State::kReference;
  if (scene.revision > planner_.revision()) return State::kMoving;
  // If the view still waited for fields, they had been released while there were no viewers. The
  // revision was already drawn, so the view continues with finer frames.
  return state_ == State::kWaitingForFields ? State::kRefining : state_;
}

std::optional<SessionWork> SessionView::In(State state, const Now& now) {
  switch (state) {
    case State::kMoving:
      return Move(now);
    case State::kRefining:
      return Refine(now);
    case State::kChecking:
      return Check(now);
    case State::kTracingLight:
      return Trace(now);
    case State::kReference:
      return ShowReference{now.shown};
    case State::kSettled:
      return Settle(now);
    case State::kWaitingForFields:
    case State::kYielded:
    case State::kFailed:
      return WaitUntil{};
  }
  THUNDERHEAD_CHECK(false, "unknown state");
}

SessionWork SessionView::Move(const Now& now) {
  return DrawFrame{now.shown, *planner_.Decide(now.shown, now.time, now.last_drawn).plan};
}

std::optional<SessionWork> SessionView::Refine(const Now& now) {
  const Decision decision = planner_.Decide(now.shown, now.time, now.last_drawn);
  if (decision.plan.has_value()) return DrawFrame{now.shown, *decision.plan};
  if (decision.ask_again_at.has_value()) return WaitUntil{decision.ask_again_at};
  state_ = State::kChecking;
  return std::nullopt;
}

std::optional<SessionWork> SessionView::Check(const Now& now) {
  if (!setting_.settled()) {
    const session::Clock::time_point settled_at = targets_.SettlesAt(now.newest);
    if (now.time < settled_at) return WaitUntil{settled_at};
    if (setting_.NeedsCheck() && planner_.DrawsWhole(*now.shown.scene)) {
      return CheckSlices{now.shown};
    }
    if (setting_.DecideAgain(now.newest)) return DrawAnew(now);
  }
  state_ = State::kTracingLight;
  return std::nullopt;
}

SessionWork SessionView::DrawAnew(const Now& now) {
  planner_.Again();
  state_ = State::kRefining;
  return WaitUntil{now.time};  // the next call decides the setting again
}

bool SessionView::IsRefuted(const Now& now) {
  if (!error_.error().has_value() || now.shown.revision != now.newest.revision) return false;
  // The error is judged only when tracing has ended, because it falls while light is being traced.
  const bool traced =
      scene::TracedLightOf(now.shown.scene->rendering.technique) != scene::TracedLight::kOff;
  if (traced && !(light_.ended() && error_.ended())) return false;
  if (!setting_.Measured(*error_.error(), now.newest)) return false;
  light_ = LightTracing();
  error_ = ErrorMeasuring();
  return true;
}

std::optional<SessionWork> SessionView::Trace(const Now& now) {
  const scene::Technique& technique = now.shown.scene->rendering.technique;
  if (planner_.DrawsWhole(*now.shown.scene)) {
    const session::Clock::time_point settled_at = targets_.SettlesAt(now.shown);
    if (now.time < settled_at) return WaitUntil{settled_at};
    light_.BeginFor(now.shown.revision, now.time);
    error_.BeginFor(now.shown.revision);
    if (IsRefuted(now)) return DrawAnew(now);
    if (light_.due() || error_.due()) return ShowLight{now.shown};
    const bool light =
        scene::TracedLightOf(technique) != scene::TracedLight::kOff && !light_.ended();
    // The error is measured again when the light has improved.
    if (light || !error_.ended()) return TraceLight{now.shown, light, true};
  }
  state_ = State::kSettled;
  return std::nullopt;
}

std::optional<SessionWork> SessionView::Settle(const Now& now) {
  const auto finer_at = planner_.FinerAt(now.shown, now.last_drawn);
  if (!finer_at.has_value() || now.time < *finer_at) return WaitUntil{finer_at};
  state_ = State::kRefining;
  return std::nullopt;
}

void SessionView::Drawn(const DrawFrame& work) {
  planner_.Drawn(work.shown.revision, work.plan);
  state_ = State::kRefining;
}

void SessionView::Checked(double discretisation_error) { setting_.Checked(discretisation_error); }

bool SessionView::LightTraced(const accuracy::LightProgress& progress,
                              session::Clock::time_point now) {
  return light_.Traced(progress, now);
}

void SessionView::Failed(std::uint64_t revision,
                         std::optional<session::Clock::time_point> try_again_at) {
  if (revision < planner_.revision()) return;  // a newer revision is shown
  planner_.GiveUp(revision);
  failed_revision_ = revision;
  try_again_at_ = try_again_at;
  state_ = State::kFailed;
}

bool SessionView::TriesAgain(session::Clock::time_point now) {
  if (state_ != State::kFailed || !try_again_at_.has_value() || now < *try_again_at_) return false;
  try_again_at_.reset();
  failed_revision_.reset();
  planner_.Again();
  state_ = State::kWaitingForFields;
  return true;
}

bool SessionView::Yield(session::Clock::time_point now, bool others_lack_pictures) {
  const bool goes_on =
      state_ == State::kTracingLight ||
      (others_lack_pictures && (state_ == State::kRefining || state_ == State::kChecking));
  if (!goes_on && state_ != State::kSettled) return false;
  returns_at_.reset();
  if (goes_on) returns_at_ = now + kYieldedFor;
  state_ = State::kYielded;
  return true;
}

std::optional<WaitUntil> SessionView::Resting(const session::NewestScene& decided,
                                              session::Clock::time_point now) {
  if (state_ != State::kYielded || decided.revision > planner_.revision()) return std::nullopt;
  if (!returns_at_.has_value() || now < *returns_at_) return WaitUntil{returns_at_};
  state_ = State::kWaitingForFields;
  return std::nullopt;
}

bool SessionView::StaysYielded(std::uint64_t revision, session::Clock::time_point now) {
  if (state_ != State::kWaitingForFields || !returns_at_.has_value() ||
      revision != planner_.revision()) {
    return false;
  }
  returns_at_ = now + kYieldedFor;
  state_ = State::kYielded;
  return true;
}

}  // namespace thunderhead::drawing
