// The render loop's work for a view at rest: choosing and checking a setting, tracing light, and
// refining a picture by the reference.
#include <utility>
#include <variant>
#include <vector>

#include "base/status.h"
#include "scene/drawn_fields.h"
#include "session/render_loop.h"

namespace thunderhead::session {
std::optional<NewestScene> RenderLoop::Decide(Session& session, Track& track,
                                              const NewestScene& shown) {
  if (!track.decided.has_value() || track.decided->revision != shown.revision) {
    std::optional<accuracy::Setting> current;
    if (track.decided.has_value() && track.decided->scene != nullptr) {
      const scene::Scene& before = *track.decided->scene;
      const bool alike = before.accuracy == shown.scene->accuracy &&
                         before.camera.index() == shown.scene->camera.index();
      if (alike) current = accuracy::SettingOf(before);
    }
    Decided decided;
    decided.revision = shown.revision;
    auto scene = offers_.Decide(*shown.scene, current);
    if (scene.ok()) decided.scene = std::make_shared<const scene::Scene>(*std::move(scene));
    track.decided = std::move(decided);
    if (!scene.ok()) Fail(session, track, shown.revision, scene.status());
  }
  if (track.decided->scene == nullptr) return std::nullopt;
  return NewestScene{shown.revision, track.decided->scene, shown.changed_at};
}

RenderLoop::Outcome RenderLoop::Check(const std::shared_ptr<Session>& session, Track& track,
                                      const NewestScene& asked) {
  // Prices are learnt as frames are drawn; after these the times are known, or do not settle.
  constexpr int kMostDecidedAgain = 3;
  Decided& decided = *track.decided;
  if (std::holds_alternative<std::monostate>(asked.scene->accuracy) || decided.settled) return {};
  const Clock::time_point settled_at = asked.changed_at + options_.targets.settle_delay;
  if (Clock::now() < settled_at) return {false, settled_at};
  const bool checkable = scene::SlicesOf(decided.scene->rendering.technique).value_or(0) >= 2;
  if (!std::exchange(decided.checked, true) && checkable) {
    DrawChecked(session, track, asked.revision);
    return {true, std::nullopt};
  }
  const accuracy::Setting current = accuracy::SettingOf(*decided.scene);
  auto again = offers_.Decide(*asked.scene, current);
  if (again.ok() && accuracy::SettingOf(*again) != current &&
      decided.decided_again < kMostDecidedAgain) {
    decided.scene = std::make_shared<const scene::Scene>(*std::move(again));
    decided.checked = false;
    ++decided.decided_again;
    track.planner.Again();
    return {false, Clock::now()};
  }
  decided.settled = true;
  return {};
}

RenderLoop::Outcome RenderLoop::TraceLight(const std::shared_ptr<Session>& session, Track& track,
                                           const NewestScene& shown) {
  // A picture is drawn anew for so many times the paths, but not more often, nor less, than this.
  constexpr double kWorthShowing = 1.5;
  constexpr double kShownAtMost_ms = 500.0;
  constexpr double kShownAtLeast_ms = 5000.0;
  const scene::Scene& scene = *shown.scene;
  if (scene::TracedLightOf(scene.rendering.technique) == scene::TracedLight::kOff) return {};
  const Clock::time_point settled_at = shown.changed_at + options_.targets.settle_delay;
  if (Clock::now() < settled_at) return {false, settled_at};
  TracedLight& light = track.traced_light;
  if (light.revision != shown.revision) light = {.revision = shown.revision};
  if (light.ended) return {};
  const auto progress = source_->TraceLight(scene, track.fields);
  if (absl::IsResourceExhausted(progress.status())) return {false, Clock::now() + kTracingLater};
  if (!progress.ok()) {
    light.ended = true;
    Fail(*session, track, shown.revision, progress.status());
    return {};
  }
  const std::int64_t paths = progress->paths;
  if (!light.begun_at.has_value()) {
    light.begun_at = *progress;
    light.shown = paths;
  }
  const accuracy::LightProgress since{paths - light.begun_at->paths,
                                      progress->steps - light.begun_at->steps};
  light.ended = progress->steps == 0 || since.HasTraced(accuracy::kTracedPaths);
  if (!progress->Corrects()) return {!light.ended, std::nullopt};
  const double ms = light.since_shown.ElapsedMs();
  const bool more = static_cast<double>(paths) >= kWorthShowing * static_cast<double>(light.shown);
  const bool show = light.ended || ms >= kShownAtLeast_ms || (more && ms >= kShownAtMost_ms);
  if (!show) return {true, std::nullopt};
  double total_ms = 0.0;
  auto picture = Draw(scene, track.fields, FrameQuality{}, total_ms);
  if (!picture.ok()) {
    light.ended = true;
    Fail(*session, track, shown.revision, picture.status());
    return {};
  }
  picture->accuracy = offers_.Report(scene, {}, track.decided->discretisation_error,
                                     picture->modelled.traced_paths);
  light.shown = paths;
  light.since_shown.Restart();
  Send(track, {session, shown.revision, scene, true, *std::move(picture), std::nullopt});
  return {true, std::nullopt};
}

void RenderLoop::DrawChecked(const std::shared_ptr<Session>& session, Track& track,
                             std::uint64_t revision) {
  const std::shared_ptr<const scene::Scene> scene = track.decided->scene;
  auto checked = source_->DrawChecked(*scene, track.fields);
  last_drawn_.reset();
  if (!checked.ok()) return Fail(*session, track, revision, checked.status());
  last_drawn_ = LastDrawn{*scene, FrameQuality{}};
  DisplayFrame& frame = checked->frame;
  double total_ms = 0.0;
  for (const StageTime& cost : frame.stages) total_ms += cost.milliseconds;
  if (const auto view_ms = accuracy::ViewMs(total_ms, frame.stages); view_ms.has_value()) {
    offers_.Observe(*scene, *view_ms);
  }
  track.decided->discretisation_error = checked->discretisation_error;
  frame.accuracy =
      offers_.Report(*scene, {}, checked->discretisation_error, frame.modelled.traced_paths);
  Send(track, {session, revision, *scene, true, std::move(frame), std::nullopt});
}

void RenderLoop::EndTrace(const std::string& session_id, Track& track, const scene::Scene& newest) {
  if (!track.traced.has_value()) return;
  if (!std::holds_alternative<scene::Reference>(newest.rendering.technique)) {
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
  picture->stages.insert(picture->stages.begin(), {scene::FrameStage::kTrace, traced.trace_ms});
  picture->modelled.technique = scene::Reference::kName;
  picture->modelled.content.fields =
      scene::HydrometeorsOf(scene::DrawnFieldsOf(*shown.scene, *track.fields));
  Send(track, {session, shown.revision, *shown.scene, traced.full_size, *std::move(picture),
               traced.refinement});
  return {true, std::nullopt};
}

}  // namespace thunderhead::session
