#include "drawing/session_drawer.h"

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

namespace thunderhead::drawing {
namespace {

// The number of times that a scene is drawn again after the device was lost while drawing it. It is
// limited because the scene itself may be the cause.
constexpr int kMaxLosses = 2;

// The time of a frame that is also drawn with half the slices, relative to the time of the frame
// alone.
constexpr double kCheckedShare = 1.5;

// Returns the scene that the work draws; null if it draws none.
const session::NewestScene* ShownBy(const SessionWork& work) {
  if (const auto* draw = std::get_if<DrawFrame>(&work)) return &draw->shown;
  if (const auto* check = std::get_if<CheckSlices>(&work)) return &check->shown;
  if (const auto* light = std::get_if<ShowLight>(&work)) return &light->shown;
  return nullptr;
}

FrameQuality QualityOf(const SessionWork& work) {
  const auto* draw = std::get_if<DrawFrame>(&work);
  return draw != nullptr ? draw->plan.quality : FrameQuality{};
}

std::shared_ptr<session::Session> FindById(
    const std::vector<std::shared_ptr<session::Session>>& sessions, const std::string& id) {
  const auto found = std::lower_bound(
      sessions.begin(), sessions.end(), id,
      [](const auto& session, const std::string& wanted) { return session->id() < wanted; });
  return found != sessions.end() && (*found)->id() == id ? *found : nullptr;
}

// Retry delay for an owner who must close a session or view first.
constexpr std::chrono::seconds kShareRetry{10};

// Returns the bytes that a frame keeps reserved until there is a newer frame.
std::size_t BytesOf(const DisplayFrame& picture) {
  return picture.memory == nullptr ? 0 : picture.memory->Bytes();
}

absl::Status PicturesBeyondShare(std::size_t bytes) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat(
          "the pictures of all your sessions and views would take more than ", base::InWords(bytes),
          " of memory, which is the maximum for one identity; close some, or request smaller "
          "pictures")),
      {.reason = "MEMORY_SHARE",
       .metadata = {{"maximum", absl::StrCat(bytes)}, {"unit", "bytes"}},
       .retry_after = kShareRetry});
}

absl::Status ReferencesBeyondShare(std::size_t references) {
  return base::WithDetails(
      absl::ResourceExhaustedError(
          absl::StrCat("the reference already traces ", references,
                       " pictures for you, which is the maximum for one identity; choose another "
                       "technique in one of them")),
      {.reason = "TOO_MANY_REFERENCES",
       .metadata = {{"maximum", absl::StrCat(references)}, {"unit", "pictures"}},
       .retry_after = kShareRetry});
}

// Returns the time at which to try again if the failure is temporary.
std::optional<session::Clock::time_point> TryAgainAt(const absl::Status& why,
                                                     session::Clock::time_point now) {
  const auto after = base::DetailsOf(why).retry_after;
  if (!after.has_value()) return std::nullopt;
  return now + *after;
}

}  // namespace

SessionDrawer::SessionDrawer(const PlannerTargets& targets, const FieldsAccess& fields,
                             MeasuredSource& source, FrameEncoder& encoder, ReferenceTracer& tracer,
                             LightTracer& light_tracer, SessionWorker& worker, const Share& share,
                             const base::TimeSource& time)
    : targets_(targets),
      fields_(fields),
      source_(source),
      encoder_(encoder),
      tracer_(tracer),
      light_tracer_(light_tracer),
      worker_(worker),
      share_(share),
      time_(time) {}

SessionDrawer::PendingWork SessionDrawer::Look(const std::shared_ptr<session::Session>& session) {
  const std::optional<session::NewestScene> newest = session->Newest();
  if (!newest.has_value() || !session->hub().HasViewers()) return {};
  const Turn turn{session, KeptFor(*session)};
  turn.kept.work = WaitUntil{};
  TakeRead(turn);
  turn.kept.reference.EndUnless(*newest->scene);
  turn.kept.gives_turn = false;
  if (const auto in_worker = LookInWorker(turn, *newest)) return *in_worker;
  if (!session->hub().HasReadyViewer() || encoder_.IsFullFor(*session)) return {};
  turn.kept.work = NextWork(turn, *newest);
  const bool traces = std::holds_alternative<TraceLight>(turn.kept.work) ||
                      std::holds_alternative<ShowLight>(turn.kept.work);
  if (!traces) light_tracer_.Stop(session->id());
  PendingWork pending =
      std::visit([&](const auto& work) { return Need(turn, work); }, turn.kept.work);
  // The work is read again here, because Need may have replaced it, for example by work that shows
  // the light traced meanwhile.
  turn.kept.in_worker = turn.kept.in_worker || IsLong(turn, turn.kept.work);
  if (turn.kept.in_worker && !worker_.IsFree()) pending.work.reset();
  return pending;
}

std::optional<SessionDrawer::PendingWork> SessionDrawer::LookInWorker(
    const Turn& turn, const session::NewestScene& newest) {
  if (!in_worker_.has_value() || !worker_.IsFor(turn.session->id())) return std::nullopt;
  // A changed scene cancels only refinement. An interactive frame is ready soon, and if each change
  // cancelled it, no frame would ever be shown.
  if (in_worker_->turn_class == TurnClass::kRefining &&
      in_worker_->newest_revision != newest.revision) {
    worker_.Cancel();
    return std::nullopt;
  }
  turn.kept.gives_turn = worker_.WantsTurn();
  if (!turn.kept.gives_turn) return PendingWork{};
  return PendingWork{in_worker_->turn_class, std::nullopt};
}

void SessionDrawer::TakeTurn(const std::shared_ptr<session::Session>& session) {
  const Turn turn{session, KeptFor(*session)};
  const SessionWork work = std::exchange(turn.kept.work, WaitUntil{});
  if (std::exchange(turn.kept.gives_turn, false)) return worker_.GiveTurn();
  if (std::exchange(turn.kept.in_worker, false)) return BeginInWorker(turn, work);
  std::visit([&](const auto& found) { Do(turn, found); }, work);
}

void SessionDrawer::BeginInWorker(const Turn& turn, const SessionWork& work) {
  const session::NewestScene& shown = *ShownBy(work);
  const auto* draw = std::get_if<DrawFrame>(&work);
  const bool refined = draw == nullptr || draw->plan.refined;
  const bool moves = turn.kept.view.state() == SessionView::State::kMoving;
  in_worker_ = InWorker{.work = work,
                        .shown = shown,
                        .fields = turn.kept.fields.Fields(),
                        .newest_revision = turn.session->Newest()->revision,
                        .turn_class = moves ? TurnClass::kInteractive : TurnClass::kRefining};
  worker_.Begin({.session_id = turn.session->id(),
                 .scene = shown.scene,
                 .fields = turn.kept.fields.Fields(),
                 .quality = QualityOf(work),
                 .checked = std::holds_alternative<CheckSlices>(work),
                 .fine = refined && WantsFine(*turn.session, shown.scene->output.width_px)});
}

void SessionDrawer::TakeDrawn(const std::vector<std::shared_ptr<session::Session>>& sessions) {
  alone_ = std::ranges::count_if(
               sessions, [](const auto& session) { return session->hub().HasViewers(); }) <= 1;
  if (!in_worker_.has_value()) return;
  worker_.WantsTurn();  // WantsTurn lets cancelled drawing run to its end
  const std::string session_id = worker_.For();
  auto picture = worker_.Take();
  if (!picture.has_value()) return;
  const InWorker drawn = *std::exchange(in_worker_, std::nullopt);
  const auto session = FindById(sessions, session_id);
  const auto kept = kept_.find(session_id);
  if (session == nullptr || kept == kept_.end() || absl::IsCancelled(picture->status())) return;
  const Turn turn{session, kept->second};
  // The frame is dropped if the session shows a newer scene by now, or has released the fields of
  // the frame.
  const std::uint64_t revision = drawn.shown.revision;
  if (revision < turn.kept.view.shown_revision()) return;
  if (picture->ok()) {
    if (turn.kept.fields.Fields() == drawn.fields) Show(turn, drawn, **std::move(picture));
  } else if (absl::IsResourceExhausted(picture->status()) && turn.kept.whole_revision != revision) {
    // The memory does not suffice for a second copy of the storm in the worker's source, so
    // the render loop's source draws the frame.
    turn.kept.whole_revision = revision;
  } else {
    Fail(turn, revision, picture->status());
  }
}

void SessionDrawer::Show(const Turn& turn, const InWorker& drawn, SessionWorker::Picture picture) {
  const session::NewestScene& shown = drawn.shown;
  const bool shows_light = std::holds_alternative<ShowLight>(drawn.work);
  source_.Learn("sessions", turn.session->id(), *shown.scene, QualityOf(drawn.work),
                shows_light
                    ? turn.kept.view.evidence()
                    : accuracy::Evidence{.discretisation_error = picture.discretisation_error},
                &picture.frame);
  if (shows_light) {
    return SendLight(turn, shown, std::move(picture.frame), std::move(picture.fine));
  }
  bool refined = true;
  if (const auto* draw = std::get_if<DrawFrame>(&drawn.work)) {
    turn.kept.view.Drawn(*draw);
    refined = draw->plan.refined;
  } else {
    turn.kept.view.Checked(*picture.discretisation_error);
  }
  Send(turn, shown, refined, std::move(picture.frame), std::move(picture.fine));
  turn.kept.fields.PrepareNext(*shown.scene);
}

SessionDrawer::Kept& SessionDrawer::KeptFor(const session::Session& session) {
  const std::string& session_id = session.id();
  const auto found = kept_.find(session_id);
  if (found != kept_.end()) return found->second;
  return kept_
      .emplace(session_id,
               Kept{session.owner(),
                    SessionView(targets_, source_.Costs(), source_.Offers(), session_id),
                    SessionFields(fields_, session_id), SessionReference(tracer_, session_id)})
      .first->second;
}

void SessionDrawer::ReleaseUnwatched(
    const std::vector<std::shared_ptr<session::Session>>& sessions) {
  for (auto kept = kept_.begin(); kept != kept_.end();) {
    const std::shared_ptr<session::Session> session = FindById(sessions, kept->first);
    if (session == nullptr || !session->hub().HasViewers()) {
      kept->second.fields.Release();
      kept->second.refused = false;
      kept->second.reference.Release();
      if (session != nullptr) session->video().Release();
      light_tracer_.Stop(kept->first);
      if (worker_.IsFor(kept->first)) worker_.Cancel();
    }
    if (session != nullptr) {
      ++kept;  // the session's view is kept, because viewers may come back
    } else {
      source_.Forget(kept->first);
      kept = kept_.erase(kept);
    }
  }
}

void SessionDrawer::YieldMemory(const std::vector<std::shared_ptr<session::Session>>& sessions) {
  for (const auto& session : sessions) {
    // The frame is drawn again when a viewer comes back.
    if (session->hub().DropUnwatched()) kept_.erase(session->id());
  }
  const session::Clock::time_point now = time_.Now();
  const bool lack_pictures =
      std::ranges::any_of(kept_, [](const auto& entry) { return entry.second.refused; });
  for (auto& [id, kept] : kept_) {
    if (worker_.IsFor(id) || !kept.view.Yield(now, lack_pictures)) continue;
    kept.work = WaitUntil{};
    kept.fields.Yield();
    light_tracer_.Stop(id);
  }
}

void SessionDrawer::TakeRead(const Turn& turn) {
  const auto unreadable = turn.kept.fields.TakeRead();
  if (!unreadable.has_value()) return;
  if (absl::IsResourceExhausted(unreadable->why) &&
      turn.kept.view.StaysYielded(unreadable->revision, time_.Now())) {
    turn.kept.fields.TryAgain();
    return;
  }
  const auto try_again_at = TryAgainAt(unreadable->why, time_.Now());
  turn.kept.refused = absl::IsResourceExhausted(unreadable->why) && try_again_at.has_value();
  turn.kept.view.Failed(unreadable->revision, try_again_at);
  turn.session->hub().Publish(delivery::UnreadableStorm(unreadable->revision, unreadable->why));
}

SessionWork SessionDrawer::NextWork(const Turn& turn, const session::NewestScene& newest) {
  const auto decided = turn.kept.view.Decide(newest);
  if (!decided.ok())
    turn.session->hub().Publish(delivery::ProblemOf(newest.revision, decided.status()));
  if (!decided.ok() || !decided->has_value()) return WaitUntil{};
  const session::Clock::time_point now = time_.Now();
  if (turn.kept.view.TriesAgain(now)) turn.kept.fields.TryAgain();
  if (const auto rests = turn.kept.view.Resting(**decided, now)) return *rests;
  const auto drawable = turn.kept.fields.Drawable(**decided, turn.kept.view.shown_revision());
  return Placed(turn, newest, drawable,
                turn.kept.view.Next(newest, drawable, now,
                                    IfDrawnFrom(turn.kept.fields.Fields(), source_.Last())));
}

SessionWork SessionDrawer::Placed(const Turn& turn, const session::NewestScene& newest,
                                  const std::optional<session::NewestScene>& drawable,
                                  SessionWork work) {
  const auto* draw = std::get_if<DrawFrame>(&work);
  const bool moves = turn.kept.view.state() == SessionView::State::kMoving;
  turn.kept.in_worker = false;
  if (draw != nullptr && moves) {
    // If a picture was drawn at rest by the worker and only its tone map changes, the worker's
    // source still has the picture's radiance. The worker then draws the new frame if its picture
    // is finer than that of the render loop.
    const scene::Scene& scene = *draw->shown.scene;
    const auto has_light = [&](const std::optional<LastDrawn>& last) {
      return FirstDirty(last, scene) >= scene::Stage::kTone;
    };
    const auto& fields = turn.kept.fields.Fields();
    const std::optional<LastDrawn>& in_worker = IfDrawnFrom(fields, worker_.Last());
    const std::optional<LastDrawn>& in_loop = IfDrawnFrom(fields, source_.Last());
    if (!worker_.IsFree() || !has_light(in_worker) || in_worker->quality.sparse) return work;
    const bool is_finer =
        !has_light(in_loop) || in_loop->quality.Scale() < in_worker->quality.Scale();
    if (!is_finer) return work;
  } else if (!IsLong(turn, work)) {
    return work;
  }
  turn.kept.in_worker = true;
  if (draw == nullptr) return work;
  return turn.kept.view.Next(newest, drawable, time_.Now(),
                             IfDrawnFrom(turn.kept.fields.Fields(), worker_.Last()));
}

bool SessionDrawer::IsLong(const Turn& turn, const SessionWork& work) const {
  const session::NewestScene* shown = ShownBy(work);
  if (shown == nullptr || shown->revision == turn.kept.whole_revision) return false;
  if (turn.kept.view.state() == SessionView::State::kMoving) return false;
  // If memory is scarce, the render loop draws the frame. A second copy of the storm for the worker
  // would make other sessions free memory.
  if (!worker_.HasRoomFor(*shown->scene, turn.kept.device_bytes)) return false;
  const scene::Stage first_dirty =
      std::min(FirstDirty(IfDrawnFrom(turn.kept.fields.Fields(), source_.Last()), *shown->scene),
               scene::Stage::kView);
  double ms =
      source_.Costs().FrameMs(turn.session->id(), *shown->scene, QualityOf(work), first_dirty);
  if (std::holds_alternative<CheckSlices>(work)) ms *= kCheckedShare;
  return ms > (alone_ ? targets_.refined_ms : targets_.whole_ms);
}

SessionDrawer::PendingWork SessionDrawer::Need(const Turn& /*turn*/, const WaitUntil& work) {
  return {std::nullopt, work.time};
}

SessionDrawer::PendingWork SessionDrawer::Need(const Turn& turn, const DrawFrame& /*work*/) {
  const bool moves = turn.kept.view.state() == SessionView::State::kMoving;
  return {moves ? TurnClass::kInteractive : TurnClass::kRefining, std::nullopt};
}

SessionDrawer::PendingWork SessionDrawer::Need(const Turn& /*turn*/, const CheckSlices& /*work*/) {
  return {TurnClass::kRefining, std::nullopt};
}

SessionDrawer::PendingWork SessionDrawer::Need(const Turn& turn, const TraceLight& work) {
  const std::string& id = turn.session->id();
  // A viewer's own view traces no light itself. It shows the light that is traced for its session.
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
    const session::Clock::time_point now = time_.Now();
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
                           absl::StrCat("path-traced correction: ", news->status().message())};
  }
  const ShowLight show{work.shown};
  turn.kept.work = show;  // `work` is invalid from here on
  return Need(turn, show);
}

SessionDrawer::PendingWork SessionDrawer::Need(const Turn& /*turn*/, const ShowLight& /*work*/) {
  return {TurnClass::kRefining, std::nullopt};
}

SessionDrawer::PendingWork SessionDrawer::Need(const Turn& turn, const ShowReference& work) {
  const absl::Status beyond = CheckReference(turn);
  const absl::StatusOr<bool> news =
      beyond.ok() ? turn.kept.reference.Trace(work.shown, turn.kept.fields.Fields()) : beyond;
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
  const session::NewestScene& shown = work.shown;
  auto picture =
      source_.Draw(turn.session->id(), *shown.scene, turn.kept.fields.Fields(), work.plan.quality);
  if (!picture.ok()) return Fail(turn, shown.revision, picture.status());
  turn.kept.view.Drawn(work);
  auto fine = work.plan.refined ? FineOf(turn, *picture) : std::nullopt;
  Send(turn, shown, work.plan.refined, *std::move(picture), std::move(fine));
  turn.kept.fields.PrepareNext(*shown.scene);
}

void SessionDrawer::Do(const Turn& turn, const CheckSlices& work) {
  const session::NewestScene& shown = work.shown;
  auto checked = source_.DrawChecked(turn.session->id(), *shown.scene, turn.kept.fields.Fields());
  if (!checked.ok()) return Fail(turn, shown.revision, checked.status());
  turn.kept.view.Checked(checked->discretisation_error);
  auto fine = FineOf(turn, checked->frame);
  Send(turn, shown, true, std::move(checked->frame), std::move(fine));
}

void SessionDrawer::Do(const Turn& /*turn*/, const TraceLight& /*work*/) {}

void SessionDrawer::Do(const Turn& turn, const ShowLight& work) {
  const absl::Status shows = DrawLight(turn, work.shown);
  if (!shows.ok()) Fail(turn, work.shown.revision, shows);
}

absl::Status SessionDrawer::DrawLight(const Turn& turn, const session::NewestScene& shown) {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      DisplayFrame picture,
      source_.Draw(turn.session->id(), *shown.scene, turn.kept.fields.Fields(), FrameQuality{},
                   turn.kept.view.evidence()));
  auto fine = FineOf(turn, picture);
  SendLight(turn, shown, std::move(picture), std::move(fine));
  return absl::OkStatus();
}

void SessionDrawer::SendLight(const Turn& turn, const session::NewestScene& shown,
                              DisplayFrame picture, std::optional<frame::FineImage> fine) {
  const auto not_shown = std::exchange(turn.kept.not_shown, std::nullopt);
  if (not_shown.has_value()) picture.modelled.content.not_shown.push_back(*not_shown);
  turn.kept.view.LightShown(time_.Now());
  Send(turn, shown, true, std::move(picture), std::move(fine));
}

void SessionDrawer::Do(const Turn& turn, const ShowReference& work) {
  const absl::Status shows = ShowTraced(turn, work.shown);
  if (shows.ok()) return;
  turn.kept.reference.Release();
  Fail(turn, work.shown.revision, shows);
}

absl::Status SessionDrawer::ShowTraced(const Turn& turn, const session::NewestScene& shown) {
  const auto& fields = turn.kept.fields.Fields();
  const ReferencePicture& traced = turn.kept.reference.TakePicture();
  THUNDERHEAD_ASSIGN_OR_RETURN(DisplayFrame picture, source_.Tone(traced.picture, *shown.scene));
  picture.stages.insert(picture.stages.begin(), {scene::FrameStage::kTrace, traced.trace_ms});
  picture.modelled.technique = scene::Reference::kName;
  picture.modelled.content.fields =
      scene::HydrometeorsOf(scene::DrawnFieldsOf(*shown.scene, *fields));
  picture.modelled.content.ground = scene::DrawnGround(*shown.scene, *fields);
  renderers::AddNotShown(*shown.scene, scene::Reference::kCapabilities, &picture.modelled.content);
  auto fine = traced.full_size ? FineOf(turn, picture) : std::nullopt;
  Send(turn, shown, traced.full_size, std::move(picture), std::move(fine), traced.refinement);
  return absl::OkStatus();
}

bool SessionDrawer::WantsFine(session::Session& session, int width_px) {
  const auto resting_tiers = session.hub().RestingTiers({width_px, width_px});
  return std::ranges::find(resting_tiers, true) != resting_tiers.end();
}

std::optional<frame::FineImage> SessionDrawer::FineOf(const Turn& turn,
                                                      const DisplayFrame& picture) {
  if (!WantsFine(*turn.session, picture.width_px)) return std::nullopt;
  // If the fine picture is not available, viewers get JPEG.
  auto fine = source_.Fine();
  return fine.ok() ? std::optional(*std::move(fine)) : std::nullopt;
}

void SessionDrawer::Send(const Turn& turn, const session::NewestScene& shown, bool refined,
                         DisplayFrame picture, std::optional<frame::FineImage> fine,
                         std::optional<delivery::Refinement> refinement) {
  if (const absl::Status beyond = CheckPicture(turn, picture); !beyond.ok()) {
    return Fail(turn, shown.revision, beyond);
  }
  turn.kept.picture_bytes = BytesOf(picture);
  turn.kept.losses = 0;
  turn.kept.refused = false;
  turn.kept.tells = picture.accuracy.has_value();
  turn.kept.device_bytes = picture.modelled.device_bytes;
  turn.kept.fields.AddStages(&picture.stages);
  DrawnFrame frame{.session = turn.session,
                   .scene_revision = shown.revision,
                   .scene = *shown.scene,
                   .refined = refined,
                   .rests_at = targets_.RestsAt(shown),
                   .fine = std::move(fine),
                   .refinement = refinement,
                   .view = scene::ViewOf(*shown.scene, *turn.kept.fields.Fields())};
  frame.picture = std::move(picture);
  encoder_.Encode(std::move(frame));
}

absl::Status SessionDrawer::CheckPicture(const Turn& turn, const DisplayFrame& picture) const {
  const std::string& owner = turn.kept.owner;
  if (owner.empty()) return absl::OkStatus();
  std::size_t bytes = BytesOf(picture);
  for (const auto& [id, other] : kept_) {
    if (other.owner == owner && &other != &turn.kept) bytes += other.picture_bytes;
  }
  return bytes <= share_.picture_bytes ? absl::OkStatus()
                                       : PicturesBeyondShare(share_.picture_bytes);
}

absl::Status SessionDrawer::CheckReference(const Turn& turn) const {
  const std::string& owner = turn.kept.owner;
  if (owner.empty() || turn.kept.reference.IsTraced()) return absl::OkStatus();
  const auto traced = std::ranges::count_if(kept_, [&](const auto& other) {
    return other.second.owner == owner && other.second.reference.IsTraced();
  });
  return static_cast<std::size_t>(traced) < share_.references
             ? absl::OkStatus()
             : ReferencesBeyondShare(share_.references);
}

void SessionDrawer::Fail(const Turn& turn, std::uint64_t revision, const absl::Status& why) {
  // A lost device is no failure of the scene yet: the same work is done again when the device has
  // been reopened.
  const bool lost = gl::IsDeviceLost(why);
  if (lost && ++turn.kept.losses <= kMaxLosses) return;
  turn.kept.view.Failed(revision, lost ? std::nullopt : TryAgainAt(why, time_.Now()));
  turn.session->hub().Publish(delivery::ProblemOf(revision, why));
}

}  // namespace thunderhead::drawing
