#include "session/image_drawer.h"

#include <optional>
#include <utility>
#include <variant>

#include "base/status.h"
#include "base/stopwatch.h"
#include "session/light_tracing.h"

namespace thunderhead::session {
namespace {

// More pictures than queues hold; those cancelled while they are prepared count as well.
constexpr std::size_t kMaxWaitingPreparations = 256;

}  // namespace

ImageDrawer::ImageDrawer(ImageQueue& queue, MeasuredSource& source,
                         std::shared_ptr<Preparation> preparation,
                         std::function<void()> on_prepared)
    : queue_(queue),
      source_(source),
      preparation_(std::move(preparation)),
      on_prepared_(std::move(on_prepared)),
      preparer_(1, kMaxWaitingPreparations) {}

TurnOutcome ImageDrawer::TakeTurn() {
  std::optional<Clock::time_point> look_again_at;
  for (std::size_t left = queue_.Count(); left > 0; --left) {
    std::optional<ImageJob> job = queue_.Take();
    if (!job.has_value()) break;
    const absl::StatusOr<Next> next = Advance(*job);
    if (!next.ok() || *next == Next::kDraw) {
      job->done(next.ok() ? Draw(*job) : next.status());
      return {true, std::nullopt};
    }
    queue_.PutBack(*std::move(job));
    if (*next == Next::kTraceOn) return {true, std::nullopt};
    if (*next == Next::kWaitForOthersLight) look_again_at = Clock::now() + kTraceAgainAfter;
  }
  return {false, look_again_at};
}

absl::StatusOr<ImageDrawer::Next> ImageDrawer::Advance(ImageJob& job) {
  if (!job.decided.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(job.decided, source_.Offers().Decide(job.scene, std::nullopt));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const bool prepared, Prepare(job));
  if (!prepared) return Next::kWaitForPreparation;
  const absl::StatusOr<bool> goes_on = Trace(job);
  if (absl::IsResourceExhausted(goes_on.status())) return Next::kWaitForOthersLight;
  THUNDERHEAD_RETURN_IF_ERROR(goes_on.status());
  return *goes_on ? Next::kTraceOn : Next::kDraw;
}

absl::StatusOr<bool> ImageDrawer::Prepare(ImageJob& job) {
  if (job.preparation != nullptr) {
    if (!job.preparation->ended) return false;
    THUNDERHEAD_RETURN_IF_ERROR(job.preparation->status);
    return true;
  }
  if (preparation_ == nullptr || preparation_->IsDone(*job.decided, job.fields)) return true;
  const auto own = std::make_shared<ImagePreparation>();
  job.preparation = own;
  preparer_.Submit([this, own, scene = *job.decided, fields = job.fields,
                    cancelled = job.cancelled](const absl::Status& status) {
    const base::Stopwatch stopwatch;
    own->status = status;
    if (status.ok() && !*cancelled) own->status = preparation_->Prepare(scene, fields);
    own->milliseconds = stopwatch.ElapsedMs();
    own->ended = true;
    on_prepared_();
  });
  return false;
}

absl::StatusOr<DisplayFrame> ImageDrawer::Draw(const ImageJob& job) {
  THUNDERHEAD_ASSIGN_OR_RETURN(DisplayFrame frame,
                               source_.Draw("", *job.decided, job.fields, FrameQuality{}));
  if (job.preparation != nullptr) {
    frame.stages.insert(frame.stages.begin(),
                        {scene::FrameStage::kFit, job.preparation->milliseconds});
  }
  return frame;
}

absl::StatusOr<bool> ImageDrawer::Trace(ImageJob& job) {
  const scene::Scene& scene = *job.decided;
  if (scene::TracedLightOf(scene.rendering.technique) != scene::TracedLight::kAwaited) return false;
  THUNDERHEAD_ASSIGN_OR_RETURN(const accuracy::LightProgress progress,
                               source_.TraceLight(scene, job.fields, &job.light));
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
