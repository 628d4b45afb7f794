#include "drawing/image_drawer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "gl/device_faults.h"

namespace thunderhead::drawing {
namespace {

// A picture whose predicted time is at most this may use the worker for quick pictures.
constexpr double kQuick_ms = 5e3;
// Maximum number of pictures that hold their fields while paths are traced for them.
constexpr std::ptrdiff_t kMaxTraced = 8;
// The time limit of a picture, as a multiple of the longest allowed prediction, because predictions
// are inexact.
constexpr double kPatience = 2.0;

bool AwaitsLight(const scene::Scene& scene) {
  return scene::TracedLightOf(scene.rendering.technique) == scene::TracedLight::kAwaited;
}

// Returns true if paths are traced before the picture is drawn.
bool IsTraced(const ImageJob& job) { return AwaitsLight(*job.decided) || job.error_seconds > 0.0; }

absl::Status TooCostly(double predicted_s, double max_s) {
  return base::InvalidField(
      "scene.output",
      absl::StrCat("asks for a picture that would take about ", std::lround(predicted_s),
                   " s to draw here; the server's limit for one picture is ", std::lround(max_s),
                   " s: ask for fewer pixels, fewer slices or a faster technique"),
      "PICTURE_TOO_COSTLY",
      {{"predicted", absl::StrCat(std::lround(predicted_s))},
       {"maximum", absl::StrCat(max_s)},
       {"unit", "s"}});
}

}  // namespace

ImageDrawer::ImageDrawer(const ImageLimits& limits, ImageQueue& queue, MeasuredSource& source,
                         std::shared_ptr<Preparation> preparation, LightTracer& tracer,
                         const Workers& workers, const base::TimeSource& time)
    : limits_(limits),
      queue_(queue),
      source_(source),
      preparation_(std::move(preparation)),
      tracer_(tracer),
      workers_(workers),
      time_(time) {}

void ImageDrawer::Attend() {
  queue_.DropCancelled();
  queue_.Admit([this](ImageJob& job) { return Admit(job); });
  for (auto image = begun_.begin(); image != begun_.end();) {
    image = Ends(*image) ? begun_.erase(image) : std::next(image);
  }
  Begin(workers_.quick);
  Begin(workers_.any);
}

absl::Status ImageDrawer::Admit(ImageJob& job) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(job.decided, source_.Offers().Decide(job.scene, std::nullopt));
  job.predicted_ms =
      source_.Costs().FrameMs("", *job.decided, FrameQuality{}, scene::Stage::kStorm);
  const double predicted_s = 1e-3 * job.predicted_ms;
  return predicted_s <= limits_.max_predicted_s ? absl::OkStatus()
                                                : TooCostly(predicted_s, limits_.max_predicted_s);
}

void ImageDrawer::Begin(Worker& worker) {
  if (!worker.IsIdle()) return;
  // Pictures that already hold their fields are started first.
  const auto ready = std::ranges::find_if(begun_, [&](const Begun& image) {
    const bool waits = image.phase == Phase::kToDraw || image.phase == Phase::kToRead;
    return waits && Suits(worker, image.quick);
  });
  if (ready != begun_.end()) return WorkIn(worker, *ready);
  const auto traced =
      std::ranges::count_if(begun_, [](const Begun& image) { return IsTraced(image.job); });
  std::optional<ImageJob> job = queue_.Take([&](const ImageJob& waits) {
    return Suits(worker, waits.predicted_ms <= kQuick_ms) &&
           (traced < kMaxTraced || !IsTraced(waits));
  });
  if (!job.has_value()) return;
  const bool quick = job->predicted_ms <= kQuick_ms;
  Begun& image = begun_.emplace_back();
  image.job = *std::move(job);
  image.name = absl::StrCat("picture ", ++count_);
  image.quick = quick;
  image.begun_at = time_.Now();
  WorkIn(worker, image);
}

void ImageDrawer::WorkIn(Worker& worker, Begun& image) {
  image.worker = &worker;
  if (image.phase == Phase::kToDraw) image.phase = Phase::kDrawing;
  if (image.phase == Phase::kToRead) image.phase = Phase::kReading;
  const bool draws = image.phase == Phase::kDrawing || !IsTraced(image.job);
  // `image` stays valid: it remains in `begun_` until the worker is idle.
  worker.Begin(
      [&image, draws, preparation = preparation_](const absl::StatusOr<FrameSource*>& source) {
        image.status = base::Guarded([&]() -> absl::Status {
          THUNDERHEAD_RETURN_IF_ERROR(source.status());
          if (image.phase == Phase::kReading) {
            THUNDERHEAD_RETURN_IF_ERROR(Read(image, preparation));
          }
          return draws ? Draw(image, **source) : absl::OkStatus();
        });
      },
      {image.job.cancelled, kPatience * 1e3 * limits_.max_predicted_s, image.job.max_work_ms,
       image.job.too_long});
}

absl::Status ImageDrawer::Read(Begun& image, const std::shared_ptr<Preparation>& preparation) {
  if (*image.job.cancelled) return absl::CancelledError("the call was cancelled");
  base::Stopwatch stopwatch;
  THUNDERHEAD_ASSIGN_OR_RETURN(ImageInput input, image.job.read());
  image.stages.push_back({scene::FrameStage::kRead, stopwatch.Restart()});
  image.job.decided->camera = input.camera;
  image.fields = std::move(input.fields);
  if (preparation == nullptr || preparation->IsDone(*image.job.decided, image.fields)) {
    return absl::OkStatus();
  }
  THUNDERHEAD_RETURN_IF_ERROR(preparation->Prepare(*image.job.decided, image.fields));
  image.stages.push_back({scene::FrameStage::kFit, stopwatch.ElapsedMs()});
  return absl::OkStatus();
}

absl::Status ImageDrawer::Draw(Begun& image, FrameSource& source) {
  THUNDERHEAD_ASSIGN_OR_RETURN(image.frame,
                               source.Draw(*image.job.decided, image.fields, FrameQuality{}));
  if (image.job.linear) {
    THUNDERHEAD_ASSIGN_OR_RETURN(image.frame->linear, source.Linear());
  }
  return image.job.encode(*image.frame);
}

// A picture is tried again if the device was lost, or if other renderers held the memory that it
// needs, which they have freed by now. After several failures, the picture itself may be the cause.
bool ImageDrawer::TriesAgain(Begun& image) {
  constexpr int kMaxAttempts = 3;
  const bool is_others = gl::IsDeviceLost(image.status) || absl::IsResourceExhausted(image.status);
  const bool may_pass =
      image.status != image.job.too_long && base::DetailsOf(image.status).retry_after.has_value();
  if (image.fields == nullptr || *image.job.cancelled || !is_others || !may_pass) return false;
  if (++image.attempts >= kMaxAttempts) return false;
  image.status = absl::OkStatus();
  image.frame.reset();
  image.phase = Phase::kToDraw;
  return true;
}

bool ImageDrawer::Ends(Begun& image) {
  if (image.phase == Phase::kTracing || image.phase == Phase::kMeasuring) {
    return EndsTracing(image);
  }
  if (image.worker == nullptr || !image.worker->IsIdle()) return false;
  image.worker = nullptr;
  if (TriesAgain(image)) return false;
  if (image.status.ok() && !image.frame.has_value()) {
    AwaitsLight(*image.job.decided) ? Trace(image) : Measure(image);
    return false;
  }
  tracer_.Stop(image.name);
  if (image.status.ok()) {
    image.job.done(Drawn(image));
  } else {
    queue_.Settle(image.job, std::nullopt);
    image.job.done(image.status);
  }
  return true;
}

void ImageDrawer::Trace(Begun& image) {
  image.phase = Phase::kTracing;
  image.wanted_paths = source_.Estimator().PathsFor(*image.job.decided, image.measured);
  tracer_.Want(image.name, {std::make_shared<const scene::Scene>(*image.job.decided), image.fields,
                            image.wanted_paths, true});
}

// No error is measured if no accuracy table covers the technique, because then no error is
// reported.
void ImageDrawer::Measure(Begun& image) {
  const bool tells = source_.Estimator().Report(*image.job.decided, {}, {}).has_value();
  if (image.job.error_seconds <= 0.0 || !tells) {
    image.phase = Phase::kToDraw;
    return;
  }
  image.phase = Phase::kMeasuring;
  tracer_.Want(image.name, {.scene = std::make_shared<const scene::Scene>(*image.job.decided),
                            .fields = image.fields,
                            .claims = true,
                            .light = false,
                            .error = true,
                            .wanted_error_s = image.job.error_seconds});
}

void ImageDrawer::TakeStep(Begun& image, const TracedStep& step) {
  if (step.light.has_value()) {
    Report(image, *step.light);
    if (step.light->steps == 0 || step.light->HasTraced(image.wanted_paths)) Measure(image);
  } else if (step.error.has_value()) {
    image.error = step.error->error;
    if (!step.error->HasTraced(image.job.error_seconds)) return;
    image.phase = IsRefuted(image) ? Phase::kToRead : Phase::kToDraw;
  }
}

bool ImageDrawer::IsRefuted(Begun& image) {
  ImageJob& job = image.job;
  const accuracy::Offers& offers = source_.Offers();
  const bool lit = AwaitsLight(*job.decided);
  accuracy::Setting drawn = accuracy::SettingOf(*job.decided);
  if (lit) drawn.million_paths = 1e-6 * static_cast<double>(image.wanted_paths);
  if (!image.error.has_value() || image.refuted >= accuracy::kMaxRefuted ||
      !offers.Refutes(*job.decided, drawn, *image.error, &image.measured)) {
    return false;
  }
  scene::Scene asked = job.scene;
  asked.camera = job.decided->camera;
  auto again = offers.Decide(asked, accuracy::SettingOf(*job.decided), image.measured);
  if (!again.ok()) return false;
  const bool other = accuracy::SettingOf(*again) != accuracy::SettingOf(*job.decided);
  const bool more_paths =
      lit && source_.Estimator().PathsFor(*again, image.measured) > image.wanted_paths;
  const double predicted_ms =
      source_.Costs().FrameMs("", *again, FrameQuality{}, scene::Stage::kStorm);
  if ((!other && !more_paths) || 1e-3 * predicted_ms > limits_.max_predicted_s) return false;
  job.decided = *std::move(again);
  job.predicted_ms = predicted_ms;
  image.quick = predicted_ms <= kQuick_ms;
  image.error.reset();
  ++image.refuted;
  tracer_.Stop(image.name);
  return true;
}

bool ImageDrawer::EndsTracing(Begun& image) {
  absl::Status failed;
  if (*image.job.cancelled) failed = absl::CancelledError("the call was cancelled");
  if (base::MsSince(time_, image.begun_at) > image.job.max_work_ms) failed = image.job.too_long;
  if (const auto news = tracer_.TakeNews(image.name); failed.ok() && news.has_value()) {
    failed = news->status();
    if (failed.ok()) TakeStep(image, **news);
  }
  if (failed.ok()) return false;
  tracer_.Stop(image.name);
  queue_.Settle(image.job, std::nullopt);
  image.job.done(failed);
  return true;
}

void ImageDrawer::Report(const Begun& image, const accuracy::LightProgress& progress) const {
  if (!image.job.on_progress || progress.steps == 0) return;
  const auto report =
      source_.Estimator().Report(*image.job.decided, {}, {.traced_paths = progress.paths});
  image.job.on_progress(
      {progress.ShareOf(image.wanted_paths), progress.paths,
       report.has_value() ? std::optional(report->estimated_error) : std::nullopt});
}

absl::StatusOr<DisplayFrame> ImageDrawer::Drawn(Begun& image) {
  source_.Learn("images", "", *image.job.decided, FrameQuality{},
                {.measured = image.error, .is_last = true}, &*image.frame);
  double drawn_ms = 0.0;
  for (const StageTime& stage : image.frame->stages) drawn_ms += stage.milliseconds;
  queue_.Settle(image.job, drawn_ms);
  image.frame->stages.insert(image.frame->stages.begin(), image.stages.begin(), image.stages.end());
  return *std::move(image.frame);
}

void ImageDrawer::EndAll(const absl::Status& why) {
  for (Begun& image : begun_) {
    if (image.status.ok() && image.frame.has_value()) {
      image.job.done(Drawn(image));
    } else {
      image.job.done(image.status.ok() ? why : image.status);
    }
  }
  begun_.clear();
}

}  // namespace thunderhead::drawing
