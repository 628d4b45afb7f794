#include "session/image_drawer.h"

#include <optional>
#include <utility>
#include <variant>

#include "base/status.h"
#include "session/light_tracing.h"

namespace thunderhead::session {

TurnOutcome ImageDrawer::TakeTurn() {
  std::optional<ImageJob> job = queue_.Take();
  if (!job.has_value()) return {};
  if (!job->decided.has_value()) {
    auto decided = source_.Offers().Decide(job->scene, std::nullopt);
    if (!decided.ok()) {
      job->done(decided.status());
      return {true, std::nullopt};
    }
    job->decided = *std::move(decided);
  }
  const absl::StatusOr<bool> goes_on = Trace(*job);
  if (absl::IsResourceExhausted(goes_on.status())) {
    queue_.PutBack(*std::move(job));
    return {false, Clock::now() + kTraceAgainAfter};
  }
  if (goes_on.ok() && *goes_on) {
    queue_.PutBack(*std::move(job));
  } else {
    job->done(goes_on.ok() ? source_.Draw("", *job->decided, job->fields, FrameQuality{})
                           : goes_on.status());
  }
  return {true, std::nullopt};
}

absl::StatusOr<bool> ImageDrawer::Trace(const ImageJob& job) {
  const scene::Scene& scene = *job.decided;
  if (scene::TracedLightOf(scene.rendering.technique) != scene::TracedLight::kAwaited) return false;
  THUNDERHEAD_ASSIGN_OR_RETURN(const accuracy::LightProgress progress,
                               source_.TraceLight(scene, job.fields));
  if (progress.steps == 0) return false;
  const std::int64_t wanted = source_.Estimator().PathsFor(scene);
  if (job.on_progress) {
    const auto report = source_.Estimator().Report(scene, {}, {progress.paths, std::nullopt});
    job.on_progress({progress.ShareOf(wanted), progress.paths,
                     report.has_value() ? std::optional(report->estimated_error) : std::nullopt});
  }
  return !progress.HasTraced(wanted);
}

}  // namespace thunderhead::session
