#include "session/session_drawer.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/log.h"
#include "base/status.h"
#include "gl/device_faults.h"
#include "renderers/content.h"
#include "scene/drawn_fields.h"
#include "scene/ground.h"
#include "scene/view.h"

namespace thunderhead::session {
namespace {

// A scene that is drawn when the device is lost is drawn again, but so often only: it may be what
// the device does not bear.
constexpr int kMaxLosses = 2;

// Where the reason of a failure passes.
std::optional<Clock::time_point> TryAgainAt(const absl::Status& why) {
  const auto after = base::DetailsOf(why).retry_after;
  if (!after.has_value()) return std::nullopt;
  return Clock::now() + *after;
}

}  // namespace

SessionDrawer::SessionDrawer(const PlannerTargets& targets, const FieldsAccess& fields,
                             MeasuredSource& source, FrameEncoder& encoder, TruthTracer& tracer,
                             LightTracer& light_tracer)
    : targets_(targets),
      fields_(fields),
      source_(source),
      encoder_(encoder),
      tracer_(tracer),
      light_tracer_(light_tracer) {}

SessionDrawer::Wish SessionDrawer::Look(const std::shared_ptr<Session>& session) {
  const std::optional<NewestScene> newest = session->Newest();
  if (!newest.has_value() || !session->hub().HasViewers()) return {};
  const Turn turn{session, KeptFor(session->id())};
  turn.kept.work = WaitUntil{};
  TakeRead(turn);
  turn.kept.reference.EndUnless(*newest->scene);
  if (!session->hub().HasReadyViewer() || encoder_.IsFullFor(*session)) return {};
  turn.kept.work = NextWork(turn, *newest);
  const bool traces = std::holds_alternative<TraceLight>(turn.kept.work) ||
                      std::holds_alternative<ShowLight>(turn.kept.work);
  if (!traces) light_tracer_.Stop(session->id());
  return std::visit([&](const auto& work) { return Need(turn, work); }, turn.kept.work);
}

void SessionDrawer::TakeTurn(const std::shared_ptr<Session>& session) {
  const Turn turn{session, KeptFor(session->id())};
  const SessionWork work = std::exchange(turn.kept.work, WaitUntil{});
  std::visit([&](const auto& found) { Do(turn, found); }, work);
}

SessionDrawer::Kept& SessionDrawer::KeptFor(const std::string& session_id) {
  const auto found = kept_.find(session_id);
  if (found != kept_.end()) return found->second;
  return kept_
      .emplace(session_id,
               Kept{SessionView(targets_, source_.Costs(), source_.Offers(), session_id),
                    SessionFields(fields_, session_id), SessionReference(tracer_, session_id)})
      .first->second;
}

void SessionDrawer::ReleaseUnwatched(const std::vector<std::shared_ptr<Session>>& sessions) {
  for (auto kept = kept_.begin(); kept != kept_.end();) {
    const auto found = std::lower_bound(
        sessions.begin(), sessions.end(), kept->first,
        [](const auto& session, const std::string& id) { return session->id() < id; });
    const bool exists = found != sessions.end() && (*found)->id() == kept->first;
    if (!exists || !(*found)->hub().HasViewers()) {
      kept->second.fields.Release();
      kept->second.reference.Release();
      if (exists) (*found)->video().Release();
      light_tracer_.Stop(kept->first);
    }
    if (exists) {
      ++kept;  // keeps its view, as it may be watched again
    } else {
      source_.Forget(kept->first);
      kept = kept_.erase(kept);
    }
  }
}

void SessionDrawer::YieldMemory() {
  const Clock::time_point now = Clock::now();
  for (auto& [id, kept] : kept_) {
    if (!kept.view.Yield(now)) continue;
    kept.work = WaitUntil{};
    kept.fields.Yield();
    light_tracer_.Stop(id);
  }
}

void SessionDrawer::TakeRead(const Turn& turn) {
  const auto unreadable = turn.kept.fields.TakeRead();
  if (!unreadable.has_value()) return;
  if (absl::IsResourceExhausted(unreadable->why) &&
      turn.kept.view.StaysYielded(unreadable->revision, Clock::now())) {
    turn.kept.fields.TryAgain();
    return;
  }
  turn.kept.view.Failed(unreadable->revision, TryAgainAt(unreadable->why));
  turn.session->hub().Publish(UnreadableStorm(unreadable->revision, unreadable->why));
}

SessionWork SessionDrawer::NextWork(const Turn& turn, const NewestScene& newest) {
  const auto decided = turn.kept.view.Decide(newest);
  if (!decided.ok()) turn.session->hub().Publish(ProblemOf(newest.revision, decided.status()));
  if (!decided.ok() || !decided->has_value()) return WaitUntil{};
  const Clock::time_point now = Clock::now();
  if (turn.kept.view.TriesAgain(now)) turn.kept.fields.TryAgain();
  if (const auto rests = turn.kept.view.Resting(**decided, now)) return *rests;
  const auto drawable = turn.kept.fields.Drawable(**decided, turn.kept.view.shown_revision());
  return turn.kept.view.Next(newest, drawable, now, source_.Last());
}

SessionDrawer::Wish SessionDrawer::Need(const Turn& /*turn*/, const WaitUntil& work) {
  return {std::nullopt, work.time};
}

SessionDrawer::Wish SessionDrawer::Need(const Turn& turn, const DrawFrame& /*work*/) {
  const bool moves = turn.kept.view.state() == SessionView::State::kMoving;
  return {moves ? TurnClass::kInteractive : TurnClass::kRefining, std::nullopt};
}

SessionDrawer::Wish SessionDrawer::Need(const Turn& /*turn*/, const CheckSlices& /*work*/) {
  return {TurnClass::kRefining, std::nullopt};
}

SessionDrawer::Wish SessionDrawer::Need(const Turn& turn, const TraceLight& work) {
  const std::string& id = turn.session->id();
  // It shows the light that is traced for its session.
  if (turn.session->IsOwnView()) {
    turn.kept.view.LightIsOthers();
    return {};
  }
  const bool error = work.error && turn.kept.tells;
  if (!error) turn.kept.view.ErrorIsUntold();
  if (!error && !work.light) return {};
  light_tracer_.Want(id, {.scene = work.shown.scene,
                          .fields = turn.kept.fields.Fields(),
                          .light = work.light,
                          .error = error});
  const auto news = light_tracer_.TakeNews(id);
  if (!news.has_value()) return {};
  if (news->ok()) {
    const Clock::time_point now = Clock::now();
    const TracedStep& step = **news;
    const bool lit = step.light.has_value() && turn.kept.view.LightTraced(*step.light, now);
    const bool told = step.error.has_value() && turn.kept.view.ErrorMeasured(*step.error, now);
    if (work.light && turn.kept.view.LightIsTraced()) light_tracer_.Stop(id);
    if (!lit && !told) return {};
  } else {
    base::LogError(base::Annotate(
        news->status(), absl::StrCat("tracing the light of storm ", work.shown.scene->storm_id)));
    turn.kept.view.LightFailed();
    turn.kept.not_shown = {scene::NotShown::Code::kTracedLight,
                           absl::StrCat("traced light: ", news->status().message())};
  }
  const ShowLight show{work.shown};
  turn.kept.work = show;  // ends the life of `work`
  return Need(turn, show);
}

SessionDrawer::Wish SessionDrawer::Need(const Turn& /*turn*/, const ShowLight& /*work*/) {
  return {TurnClass::kRefining, std::nullopt};
}

SessionDrawer::Wish SessionDrawer::Need(const Turn& turn, const ShowReference& work) {
  const absl::StatusOr<bool> news =
      turn.kept.reference.Trace(work.shown, turn.kept.fields.Fields());
  if (!news.ok()) {
    turn.kept.reference.Release();
    Fail(turn, work.shown.revision, news.status());
    return {};
  }
  turn.kept.view.ReferenceShown(work.shown.revision);
  if (!*news) return {};
  return {TurnClass::kInteractive, std::nullopt};
}

void SessionDrawer::Do(const Turn& /*turn*/, const WaitUntil& /*work*/) {}

void SessionDrawer::Do(const Turn& turn, const DrawFrame& work) {
  const NewestScene& shown = work.shown;
  auto picture =
      source_.Draw(turn.session->id(), *shown.scene, turn.kept.fields.Fields(), work.plan.quality);
  if (!picture.ok()) return Fail(turn, shown.revision, picture.status());
  turn.kept.view.Drawn(work);
  Send(turn, shown, work.plan.refined, *std::move(picture));
  turn.kept.fields.PrepareNext(*shown.scene);
}

void SessionDrawer::Do(const Turn& turn, const CheckSlices& work) {
  const NewestScene& shown = work.shown;
  auto checked = source_.DrawChecked(turn.session->id(), *shown.scene, turn.kept.fields.Fields());
  if (!checked.ok()) return Fail(turn, shown.revision, checked.status());
  turn.kept.view.Checked(checked->discretisation_error);
  Send(turn, shown, true, std::move(checked->frame));
}

void SessionDrawer::Do(const Turn& /*turn*/, const TraceLight& /*work*/) {}

void SessionDrawer::Do(const Turn& turn, const ShowLight& work) {
  const absl::Status shows = DrawLight(turn, work.shown);
  if (!shows.ok()) Fail(turn, work.shown.revision, shows);
}

absl::Status SessionDrawer::DrawLight(const Turn& turn, const NewestScene& shown) {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      DisplayFrame picture,
      source_.Draw(turn.session->id(), *shown.scene, turn.kept.fields.Fields(), FrameQuality{},
                   turn.kept.view.evidence()));
  const auto not_shown = std::exchange(turn.kept.not_shown, std::nullopt);
  if (not_shown.has_value()) picture.modelled.content.not_shown.push_back(*not_shown);
  turn.kept.view.LightShown(Clock::now());
  Send(turn, shown, true, std::move(picture));
  return absl::OkStatus();
}

void SessionDrawer::Do(const Turn& turn, const ShowReference& work) {
  const absl::Status shows = ShowTraced(turn, work.shown);
  if (shows.ok()) return;
  turn.kept.reference.Release();
  Fail(turn, work.shown.revision, shows);
}

absl::Status SessionDrawer::ShowTraced(const Turn& turn, const NewestScene& shown) {
  const auto& fields = turn.kept.fields.Fields();
  const TruthPicture& traced = turn.kept.reference.TakePicture();
  THUNDERHEAD_ASSIGN_OR_RETURN(DisplayFrame picture, source_.Tone(traced.picture, *shown.scene));
  picture.stages.insert(picture.stages.begin(), {scene::FrameStage::kTrace, traced.trace_ms});
  picture.modelled.technique = scene::Reference::kName;
  picture.modelled.content.fields =
      scene::HydrometeorsOf(scene::DrawnFieldsOf(*shown.scene, *fields));
  renderers::AddNotShown(*shown.scene, scene::Reference::kCapabilities, &picture.modelled.content);
  picture.modelled.content.ground = scene::DrawnGround(*shown.scene, *fields);
  Send(turn, shown, traced.full_size, std::move(picture), traced.refinement);
  return absl::OkStatus();
}

void SessionDrawer::Send(const Turn& turn, const NewestScene& shown, bool refined,
                         DisplayFrame picture, std::optional<Refinement> refinement) {
  turn.kept.losses = 0;
  turn.kept.tells = picture.accuracy.has_value();
  turn.kept.fields.AddStages(&picture.stages);
  DrawnFrame frame{.session = turn.session,
                   .scene_revision = shown.revision,
                   .scene = *shown.scene,
                   .refined = refined,
                   .rests_at = targets_.RestsAt(shown),
                   .refinement = refinement,
                   .view = scene::ViewOf(*shown.scene, *turn.kept.fields.Fields())};
  const auto still_tiers = turn.session->hub().StillTiers(picture.width_px);
  if (refined && std::ranges::find(still_tiers, true) != still_tiers.end()) {
    // Those who would take it get JPEG where it cannot be had.
    if (auto fine = source_.Fine(); fine.ok()) frame.fine = *std::move(fine);
  }
  frame.picture = std::move(picture);
  encoder_.Encode(std::move(frame));
}

void SessionDrawer::Fail(const Turn& turn, std::uint64_t revision, const absl::Status& why) {
  // The same work comes again when there is a device.
  const bool lost = gl::IsDeviceLost(why);
  if (lost && ++turn.kept.losses <= kMaxLosses) return;
  turn.kept.view.Failed(revision, lost ? std::nullopt : TryAgainAt(why));
  turn.session->hub().Publish(ProblemOf(revision, why));
}

}  // namespace thunderhead::session
