#include "session/render_loop.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/stopwatch.h"

namespace thunderhead::session {
namespace {

absl::Status Stopping() { return absl::UnavailableError("the server is shutting down"); }

FieldsKey KeyOf(const scene::Scene& scene) { return {scene.storm_id, scene.time_index}; }

std::optional<Clock::time_point> Earlier(const std::optional<Clock::time_point>& a,
                                         const std::optional<Clock::time_point>& b) {
  if (!a.has_value()) return b;
  if (!b.has_value()) return a;
  return std::min(*a, *b);
}

std::vector<physics::Hydrometeor> DrawnFields(const scene::Scene& scene,
                                              const volume::HydrometeorFields& fields) {
  std::vector<physics::Hydrometeor> drawn;
  for (const volume::HydrometeorField& field : fields.fields) {
    const scene::FieldParameters& look = scene.fields[physics::IndexOf(field.hydrometeor)];
    if (!look.visible || look.scale <= 0.0F || field.concentration_kg_per_m3.empty()) continue;
    drawn.push_back(field.hydrometeor);
  }
  return drawn;
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
      refusal = Stopping();
    } else if (images_.size() >= options_.max_waiting_images) {
      refusal = absl::ResourceExhaustedError(absl::StrCat(
          "the server is busy: ", images_.size(), " pictures wait to be drawn; try again later"));
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
  const std::optional<NewestScene> shown = DrawableScene(*session, track, *newest);
  if (!shown.has_value()) return {};
  if (shown->scene->rendering.renderer == scene::Renderer::kReference) {
    return ShowTraced(session, track, *shown);
  }
  const Decision decision = track.planner.Decide(*shown, Clock::now(), last_drawn_);
  if (!decision.plan.has_value()) return {false, decision.ask_again_at};
  DrawFor(session, track, *shown, *decision.plan);
  return {true, std::nullopt};
}

void RenderLoop::TakeRead(Session& session, Track& track) {
  std::optional<FieldsRead> read = reader_->Take(session.id());
  if (!read.has_value() || !track.reading_for.has_value()) return;
  const NewestScene reading_for = *std::exchange(track.reading_for, std::nullopt);
  if (!read->fields.ok()) {
    track.planner.GiveUp(reading_for.revision);
    track.unreadable_revision = reading_for.revision;
    session.hub().Publish(
        Problem{reading_for.revision, std::string(read->fields.status().message())});
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
  track.planner.Drawn(shown.revision, *shown.scene, plan, total_ms,
                      was_warm ? picture->stages : std::vector<StageCost>());
  Send(track,
       {session, shown.revision, *shown.scene, plan.refined, *std::move(picture), std::nullopt});
}

void RenderLoop::Send(Track& track, DrawnFrame frame) {
  std::vector<StageCost>& stages = frame.picture.stages;
  if (track.prepare_ms > 1.0) stages.insert(stages.begin(), {"fit", track.prepare_ms});
  track.prepare_ms = 0.0;
  if (track.read_ms > 0.0) {
    stages.insert(stages.begin(), {"read", std::exchange(track.read_ms, 0.0)});
  }
  encoder_->Encode(std::move(frame));
}

void RenderLoop::Fail(Session& session, Track& track, std::uint64_t revision,
                      const absl::Status& why) {
  track.planner.GiveUp(revision);
  session.hub().Publish(Problem{revision, std::string(why.message())});
}

void RenderLoop::EndTrace(const std::string& session_id, Track& track, const scene::Scene& newest) {
  if (!track.traced.has_value()) return;
  if (newest.rendering.renderer != scene::Renderer::kReference) {
    tracer_->Forget(session_id);
    track.traced.reset();
  } else if (scene::FirstDirtyStage(*track.traced->shown.scene, newest) < scene::Stage::kTone) {
    tracer_->Stop(session_id);
    track.traced.reset();
  }
}

absl::StatusOr<bool> RenderLoop::Trace(const std::string& session_id, Track& track,
                                       const NewestScene& shown) {
  if (!track.traced.has_value()) {
    if (track.untraceable_revision == shown.revision) return false;
    track.traced = Traced{shown, nullptr};
    THUNDERHEAD_RETURN_IF_ERROR(tracer_->Trace(session_id, shown.scene, track.fields));
    return false;
  }
  Traced& traced = *track.traced;
  // Another exposure shows what was traced so far in another light.
  bool news = traced.picture != nullptr && shown.revision > traced.shown.revision;
  traced.shown = shown;
  if (auto taken = tracer_->Take(session_id); taken.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(traced.picture, *std::move(taken));
    news = true;
  }
  return news;
}

RenderLoop::Outcome RenderLoop::ShowTraced(const std::shared_ptr<Session>& session, Track& track,
                                           const NewestScene& shown) {
  const auto fail = [&](const absl::Status& why) -> Outcome {
    tracer_->Forget(session->id());
    track.traced.reset();
    track.untraceable_revision = shown.revision;
    Fail(*session, track, shown.revision, why);
    return {};
  };
  const absl::StatusOr<bool> news = Trace(session->id(), track, shown);
  if (!news.ok()) return fail(news.status());
  track.planner.GiveUp(shown.revision);
  if (!*news) return {};
  const TruthPicture& traced = *track.traced->picture;
  auto picture = source_->Tone(traced.picture, shown.scene->display);
  if (!picture.ok()) return fail(picture.status());
  picture->stages.insert(picture->stages.begin(), {"trace", traced.trace_ms});
  picture->modelled.renderer = scene::Renderer::kReference;
  picture->modelled.fields = DrawnFields(*shown.scene, *track.fields);
  Send(track, {session, shown.revision, *shown.scene, traced.full_size, *std::move(picture),
               traced.refinement});
  return {true, std::nullopt};
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
  // The first frame compiles shaders; its time foretells nothing.
  if (std::exchange(warm_, true)) {
    machine_costs_.Of(scene).Observe(MegaSamples(scene, quality), total_ms, picture->stages);
  }
  return picture;
}

RenderLoop::Outcome RenderLoop::TryImage() {
  std::optional<ImageJob> job = NextImage();
  if (!job.has_value()) return {};
  double total_ms = 0.0;
  job->done(Draw(job->scene, job->fields, FrameQuality{}, total_ms));
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
  for (const ImageJob& job : refused) job.done(Stopping());
}

}  // namespace thunderhead::session
