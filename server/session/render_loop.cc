#include "session/render_loop.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "accuracy/named_settings.h"
#include "base/error_details.h"
#include "base/status.h"
#include "base/stopwatch.h"

namespace thunderhead::session {
namespace {

// The time of a few pictures.
constexpr std::chrono::seconds kRetryImageAfter{5};

absl::Status TooManyImages(std::size_t waiting) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat("the server is busy: ", waiting,
                                                " pictures wait to be drawn; try again later")),
      {.reason = "RENDER_QUEUE_FULL",
       .metadata = {{"maximum", absl::StrCat(waiting)}, {"unit", "pictures"}},
       .retry_after = kRetryImageAfter});
}

FieldsKey KeyOf(const scene::Scene& scene) { return {scene.storm_id, scene.time_index}; }

std::optional<Clock::time_point> Earlier(const std::optional<Clock::time_point>& a,
                                         const std::optional<Clock::time_point>& b) {
  if (!a.has_value()) return b;
  if (!b.has_value()) return a;
  return std::min(*a, *b);
}

}  // namespace

absl::StatusOr<std::unique_ptr<RenderLoop>> RenderLoop::Start(
    const RenderLoopOptions& options, volume::StormStore& store, Sessions& sessions,
    base::WakeSignal& wake, const FrameSourceFactory& make_source) {
  std::unique_ptr<RenderLoop> loop(new RenderLoop(options, store, sessions, wake));
  std::promise<absl::Status> started;
  std::future<absl::Status> status = started.get_future();
  loop->thread_ =
      std::thread([raw = loop.get(), make_source, promise = std::move(started)]() mutable {
        raw->Run(make_source, std::move(promise));
      });
  THUNDERHEAD_RETURN_IF_ERROR(status.get());
  return loop;
}

RenderLoop::RenderLoop(const RenderLoopOptions& options, volume::StormStore& store,
                       Sessions& sessions, base::WakeSignal& wake)
    : options_(options),
      store_(store),
      sessions_(sessions),
      wake_(wake),
      offers_(options.offer_tables()),
      reader_(std::make_unique<FieldsReader>(store, [&wake] { wake.Notify(); })),
      encoder_(std::make_unique<FrameEncoder>(options.encoder_threads, [&wake] { wake.Notify(); })),
      tracer_(std::make_unique<TruthTracer>(options.make_truth_source, options.max_traced_sessions,
                                            [&wake] { wake.Notify(); })) {}

RenderLoop::~RenderLoop() { Stop(); }

void RenderLoop::RequestStop() {
  stopping_ = true;
  wake_.Notify();
}

void RenderLoop::Stop() {
  RequestStop();
  if (thread_.joinable()) thread_.join();
  reader_.reset();
  tracer_.reset();
  encoder_.reset();
}

void RenderLoop::RenderImage(ImageJob job) {
  absl::Status refusal;
  {
    const std::lock_guard lock(images_mutex_);
    if (refuses_images_) {
      refusal = base::ShuttingDown();
    } else if (images_.size() >= options_.max_waiting_images) {
      refusal = TooManyImages(images_.size());
    } else {
      images_.push_back(std::move(job));
    }
  }
  if (!refusal.ok()) return job.done(refusal);
  wake_.Notify();
}

void RenderLoop::Run(const FrameSourceFactory& make_source, std::promise<absl::Status> started) {
  auto source = make_source();
  if (!source.ok()) {
    RefuseImages();
    started.set_value(source.status());
    return;
  }
  source_ = *std::move(source);
  device_ = source_->Device();
  techniques_ = source_->Techniques();
  preparation_ = source_->PreparationOfScenes();
  started.set_value(absl::OkStatus());
  while (!stopping_) {
    const std::optional<Clock::time_point> look_again_at = DrawOne();
    if (!look_again_at.has_value() || *look_again_at > Clock::now()) wake_.Wait(look_again_at);
  }
  RefuseImages();
  tracks_.clear();
  source_.reset();
}

// Goes round the sessions and the pictures that wait, from the one after the last served, until one
// of them has something drawn. Returns when to look again without being woken.
std::optional<Clock::time_point> RenderLoop::DrawOne() {
  const std::vector<std::shared_ptr<Session>> sessions = sessions_.All();
  DropEndedTracks(sessions);
  const std::size_t turns = sessions.size() + 1;
  const auto after_last = std::upper_bound(
      sessions.begin(), sessions.end(), last_served_,
      [](const std::string& id, const auto& session) { return id < session->id(); });
  // Turn 0 is the pictures' (whose id, the empty string, is before every session's).
  const std::size_t first = static_cast<std::size_t>(after_last - sessions.begin()) + 1;
  std::optional<Clock::time_point> look_again_at;
  for (std::size_t i = 0; i < turns; ++i) {
    const std::size_t turn = (first + i) % turns;
    const Outcome outcome = turn == 0 ? TryImage() : TrySession(sessions[turn - 1]);
    if (outcome.drew) {
      last_served_ = turn == 0 ? "" : sessions[turn - 1]->id();
      return Clock::now();
    }
    look_again_at = Earlier(look_again_at, outcome.look_again_at);
  }
  return look_again_at;
}

// Gives back the memory of what a session without viewers shows, and its work in progress.
void RenderLoop::LetGo(const std::string& session_id, Track& track) {
  reader_->Forget(session_id);
  tracer_->Forget(session_id);
  track.fields.reset();
  track.fields_key.reset();
  track.reading_for.reset();
  track.arrived_for.reset();
  track.drawn_key.reset();
  track.traced.reset();
}

void RenderLoop::DropEndedTracks(const std::vector<std::shared_ptr<Session>>& sessions) {
  for (auto track = tracks_.begin(); track != tracks_.end();) {
    const auto found = std::lower_bound(
        sessions.begin(), sessions.end(), track->first,
        [](const auto& session, const std::string& id) { return session->id() < id; });
    const bool watched =
        found != sessions.end() && (*found)->id() == track->first && (*found)->hub().HasViewers();
    if (watched) {
      ++track;
      continue;
    }
    LetGo(track->first, track->second);
    if (found != sessions.end() && (*found)->id() == track->first) {
      // It may be watched again.
      ++track;
    } else {
      track = tracks_.erase(track);
    }
  }
}

RenderLoop::Outcome RenderLoop::TrySession(const std::shared_ptr<Session>& session) {
  const std::optional<NewestScene> newest = session->Newest();
  if (!newest.has_value() || !session->hub().HasViewers()) return {};
  const auto [entry, is_new] =
      tracks_.try_emplace(session->id(), Track{FramePlanner(options_.targets, machine_costs_)});
  Track& track = entry->second;
  TakeRead(*session, track);
  EndTrace(session->id(), track, *newest->scene);
  if (!session->hub().HasReadyViewer() || encoder_->IsFullFor(*session)) return {};
  const std::optional<NewestScene> decided = Decide(*session, track, *newest);
  if (!decided.has_value()) return {};
  const std::optional<NewestScene> shown = DrawableScene(*session, track, *decided);
  if (!shown.has_value()) return {};
  if (std::holds_alternative<scene::Reference>(shown->scene->rendering.technique)) {
    return ShowTraced(session, track, *shown);
  }
  const Decision decision = track.planner.Decide(*shown, Clock::now(), last_drawn_);
  if (decision.plan.has_value()) {
    DrawFor(session, track, *shown, *decision.plan);
    return {true, std::nullopt};
  }
  if (decision.ask_again_at.has_value()) return {false, decision.ask_again_at};
  const Outcome checked = Check(session, track, *newest);
  if (checked.drew || checked.look_again_at.has_value()) return checked;
  return TraceLight(session, track, *shown);
}

void RenderLoop::TakeRead(Session& session, Track& track) {
  std::optional<FieldsRead> read = reader_->Take(session.id());
  if (!read.has_value() || !track.reading_for.has_value()) return;
  const NewestScene reading_for = *std::exchange(track.reading_for, std::nullopt);
  if (!read->fields.ok()) {
    track.planner.GiveUp(reading_for.revision);
    track.unreadable_revision = reading_for.revision;
    session.hub().Publish(UnreadableStorm(reading_for.revision, read->fields.status()));
    return;
  }
  track.fields = *std::move(read->fields);
  track.fields_key = KeyOf(*reading_for.scene);
  track.arrived_for = reading_for;
  track.read_ms += read->milliseconds;
  track.prepare_ms += read->prepare_ms;
}

bool RenderLoop::IsPrepared(const scene::Scene& scene,
                            const std::shared_ptr<const volume::HydrometeorFields>& fields) const {
  return preparation_ == nullptr || preparation_->IsDone(scene, fields);
}

absl::Status RenderLoop::Prepare(
    const scene::Scene& scene,
    const std::shared_ptr<const volume::HydrometeorFields>& fields) const {
  return preparation_ == nullptr ? absl::OkStatus() : preparation_->Prepare(scene, fields);
}

void RenderLoop::AskFor(const Session& session, const NewestScene& newest) {
  PrepareFields prepare;
  if (preparation_ != nullptr) {
    prepare = [preparation = preparation_, scene = newest.scene](const auto& fields) {
      return preparation->Prepare(*scene, fields);
    };
  }
  reader_->Ask(session.id(), KeyOf(*newest.scene), std::move(prepare));
}

void RenderLoop::PrepareNext(const Session& session, Track& track, const scene::Scene& shown) {
  const FieldsKey key = KeyOf(shown);
  const std::optional<FieldsKey> before = std::exchange(track.drawn_key, key);
  const bool goes_on = before.has_value() && before->storm_id == key.storm_id &&
                       before->time_index + 1 == key.time_index;
  if (!goes_on || preparation_ == nullptr || !preparation_->IsNeeded(shown)) return;
  const volume::StormInfo* storm = store_.Find(key.storm_id);
  if (storm == nullptr || key.time_index + 1 >= static_cast<int>(storm->times.size())) return;
  auto next = std::make_shared<scene::Scene>(shown);
  ++next->time_index;
  reader_->AskAhead(session.id(), KeyOf(*next),
                    [preparation = preparation_, next](const auto& fields) {
                      return preparation->Prepare(*next, fields);
                    });
}

// The scene to draw now: the newest if its fields are at hand. If they are not they are asked for,
// and meanwhile the scene whose fields have just been read is drawn, if it is newer than what is
// shown: so a time slider that moves faster than the disk still shows something.
std::optional<NewestScene> RenderLoop::DrawableScene(const Session& session, Track& track,
                                                     const NewestScene& newest) {
  const FieldsKey key = KeyOf(*newest.scene);
  const std::optional<NewestScene> arrived_for = std::exchange(track.arrived_for, std::nullopt);
  if (track.fields_key == key && IsPrepared(*newest.scene, track.fields)) return newest;
  if (track.unreadable_revision == newest.revision) return std::nullopt;
  if (auto cached = store_.Peek(key.storm_id, key.time_index);
      cached != nullptr && IsPrepared(*newest.scene, cached)) {
    track.fields = std::move(cached);
    track.fields_key = key;
    // Asked for all the same: it is the store's Get that reads the next times ahead.
    track.reading_for.reset();
    reader_->Ask(session.id(), key);
    return newest;
  }
  if (!track.reading_for.has_value()) {
    track.reading_for = newest;
    AskFor(session, newest);
  }
  const bool is_news = arrived_for.has_value() && arrived_for->revision > track.planner.revision();
  return is_news ? arrived_for : std::nullopt;
}

void RenderLoop::DrawFor(const std::shared_ptr<Session>& session, Track& track,
                         const NewestScene& shown, const FramePlan& plan) {
  const bool was_warm = warm_;
  double total_ms = 0.0;
  auto picture = Draw(*shown.scene, track.fields, plan.quality, total_ms);
  if (!picture.ok()) return Fail(*session, track, shown.revision, picture.status());
  picture->accuracy =
      offers_.Report(*shown.scene, plan.quality, std::nullopt, picture->modelled.traced_paths);
  track.planner.Drawn(shown.revision, *shown.scene, plan, total_ms,
                      was_warm ? picture->stages : std::vector<StageTime>());
  Send(track,
       {session, shown.revision, *shown.scene, plan.refined, *std::move(picture), std::nullopt});
  PrepareNext(*session, track, *shown.scene);
}

void RenderLoop::Send(Track& track, DrawnFrame frame) {
  std::vector<StageTime>& stages = frame.picture.stages;
  if (track.prepare_ms > 1.0)
    stages.insert(stages.begin(), {scene::FrameStage::kFit, track.prepare_ms});
  track.prepare_ms = 0.0;
  if (track.read_ms > 0.0) {
    stages.insert(stages.begin(), {scene::FrameStage::kRead, std::exchange(track.read_ms, 0.0)});
  }
  encoder_->Encode(std::move(frame));
}

void RenderLoop::Fail(Session& session, Track& track, std::uint64_t revision,
                      const absl::Status& why) {
  track.planner.GiveUp(revision);
  if (track.decided.has_value()) track.decided->settled = true;
  session.hub().Publish(ProblemOf(revision, why));
}

absl::StatusOr<DisplayFrame> RenderLoop::Draw(
    const scene::Scene& scene, const std::shared_ptr<const volume::HydrometeorFields>& fields,
    const FrameQuality& quality, double& total_ms) {
  const base::Stopwatch stopwatch;
  auto picture = source_->Draw(scene, fields, quality);
  total_ms = stopwatch.ElapsedMs();
  if (!picture.ok()) {
    last_drawn_.reset();
    return picture;
  }
  last_drawn_ = LastDrawn{scene, quality};
  // The time of the first frame is not representative: it includes shader compilation.
  if (std::exchange(warm_, true)) {
    machine_costs_.Of(scene).Observe(accuracy::MegaSamples(scene, quality), total_ms,
                                     picture->stages);
  }
  const scene::Technique& technique = scene.rendering.technique;
  const bool compiled =
      !compiled_
           .emplace(scene::NameOf(technique), accuracy::ModeOf(technique).name,
                    accuracy::TransportNameOf(technique), picture->modelled.traced_paths > 0)
           .second;
  if (compiled && quality == FrameQuality{}) {
    const std::optional<double> view_ms = accuracy::ViewMs(total_ms, picture->stages);
    if (view_ms.has_value()) offers_.Observe(scene, *view_ms);
  }
  return picture;
}

absl::StatusOr<DisplayFrame> RenderLoop::DrawImage(const ImageJob& job) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const scene::Scene scene, offers_.Decide(job.scene, std::nullopt));
  double total_ms = 0.0;
  THUNDERHEAD_ASSIGN_OR_RETURN(DisplayFrame picture,
                               Draw(scene, job.fields, FrameQuality{}, total_ms));
  picture.accuracy = offers_.Report(scene, {}, std::nullopt, picture.modelled.traced_paths);
  return picture;
}

// A picture that awaits traced light takes its turns until enough paths are traced: for the error
// that it asks for, if it does. True if it has to go on.
absl::StatusOr<bool> RenderLoop::TraceForImage(const ImageJob& job) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const scene::Scene scene, offers_.Decide(job.scene, std::nullopt));
  if (scene::TracedLightOf(scene.rendering.technique) != scene::TracedLight::kAwaited) return false;
  THUNDERHEAD_ASSIGN_OR_RETURN(const accuracy::LightProgress progress,
                               source_->TraceLight(scene, job.fields));
  if (progress.steps == 0) return false;
  const std::int64_t wanted = offers_.PathsFor(scene);
  if (job.on_progress) {
    const auto report = offers_.Report(scene, {}, std::nullopt, progress.paths);
    job.on_progress({progress.ShareOf(wanted), progress.paths,
                     report.has_value() ? std::optional(report->estimated_error) : std::nullopt});
  }
  return !progress.HasTraced(wanted);
}

RenderLoop::Outcome RenderLoop::TryImage() {
  std::optional<ImageJob> job = NextImage();
  if (!job.has_value()) return {};
  const absl::StatusOr<bool> goes_on = TraceForImage(*job);
  const bool waits = absl::IsResourceExhausted(goes_on.status());
  if (waits || (goes_on.ok() && *goes_on)) {
    const std::lock_guard lock(images_mutex_);
    images_.push_back(*std::move(job));  // others have their turn
    if (waits) return {false, Clock::now() + kTracingLater};
    return {true, std::nullopt};
  }
  job->done(goes_on.ok() ? DrawImage(*job) : goes_on.status());
  return {true, std::nullopt};
}

std::optional<ImageJob> RenderLoop::NextImage() {
  std::vector<ImageJob> cancelled;
  std::optional<ImageJob> next;
  {
    const std::lock_guard lock(images_mutex_);
    for (auto job = images_.begin(); job != images_.end();) {
      if (*job->cancelled) {
        cancelled.push_back(std::move(*job));
        job = images_.erase(job);
      } else {
        ++job;
      }
    }
    if (!images_.empty()) {
      next = std::move(images_.front());
      images_.pop_front();
    }
  }
  for (const ImageJob& job : cancelled) {
    job.done(absl::CancelledError("the picture was no longer wanted"));
  }
  return next;
}

void RenderLoop::RefuseImages() {
  std::deque<ImageJob> refused;
  {
    const std::lock_guard lock(images_mutex_);
    refuses_images_ = true;
    refused.swap(images_);
  }
  for (const ImageJob& job : refused) job.done(base::ShuttingDown());
}

}  // namespace thunderhead::session
