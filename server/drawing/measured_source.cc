#include "drawing/measured_source.h"

#include <utility>

#include "base/guarded.h"
#include "base/status.h"

namespace thunderhead::drawing {
namespace {

double TotalMs(const DisplayFrame& frame) {
  double total_ms = 0.0;
  for (const StageTime& cost : frame.stages) total_ms += cost.milliseconds;
  return total_ms;
}

}  // namespace

MeasuredSource::MeasuredSource(std::unique_ptr<FrameSource> source, accuracy::OfferTables tables,
                               const base::TimeSource& time)
    : source_(std::move(source)), tables_(std::move(tables)), time_(time) {}

absl::StatusOr<DisplayFrame> MeasuredSource::Draw(const std::string& view,
                                                  const scene::Scene& scene, const Fields& fields,
                                                  const FrameQuality& quality,
                                                  const accuracy::Evidence& evidence) {
  last_drawn_.reset();
  const auto begun_at = time_.Now();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      DisplayFrame frame, base::Guarded([&] { return source_->Draw(scene, fields, quality); }));
  last_drawn_ = LastDrawn{scene, quality, fields};
  Report(view, {scene, quality, base::MsSince(time_, begun_at), frame.stages}, evidence, &frame);
  return frame;
}

absl::StatusOr<CheckedFrame> MeasuredSource::DrawChecked(const std::string& view,
                                                         const scene::Scene& scene,
                                                         const Fields& fields) {
  last_drawn_.reset();
  THUNDERHEAD_ASSIGN_OR_RETURN(CheckedFrame checked,
                               base::Guarded([&] { return source_->DrawChecked(scene, fields); }));
  last_drawn_ = LastDrawn{scene, FrameQuality{}, fields};
  Report(view, {scene, FrameQuality{}, TotalMs(checked.frame), checked.frame.stages},
         {.discretisation_error = checked.discretisation_error}, &checked.frame);
  return checked;
}

void MeasuredSource::Learn(std::string_view worker, const std::string& view,
                           const scene::Scene& scene, const FrameQuality& quality,
                           const accuracy::Evidence& evidence, DisplayFrame* frame) {
  Report(view, {scene, quality, TotalMs(*frame), frame->stages, false, worker}, evidence, frame);
}

absl::StatusOr<DisplayFrame> MeasuredSource::Tone(const picture::LinearPicture& picture,
                                                  const scene::Scene& scene) {
  return base::Guarded([&] { return source_->Tone(picture, scene); });
}

absl::StatusOr<frame::FineImage> MeasuredSource::Fine() {
  return base::Guarded([&] { return source_->Fine(); });
}

void MeasuredSource::Replace(std::unique_ptr<FrameSource> source) {
  last_drawn_.reset();
  source_ = std::move(source);
}

void MeasuredSource::Report(const std::string& view, accuracy::MeasuredFrame measured,
                            accuracy::Evidence evidence, DisplayFrame* frame) {
  evidence.traced_paths = frame->modelled.traced_paths;
  measured.traced = evidence.traced_paths > 0;
  costs_.Observe(view, measured);
  frame->accuracy = estimator_.Report(measured.scene, measured.quality, evidence);
}

}  // namespace thunderhead::drawing
