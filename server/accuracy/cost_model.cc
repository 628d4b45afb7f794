#include "accuracy/cost_model.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::accuracy {
namespace {

// The factor by which the weight of older frames decreases with each frame, to a third in five
// frames. This is fast enough to follow a camera that flies into the cloud. It is slow enough to
// determine both coefficients of a + b (pixels x slices), the formula in cost_model.h.
constexpr double kForgetting = 0.8;
// If the variance of x (the number of samples), divided by its mean square, is below this value, a
// and b cannot be determined separately.
constexpr double kMinRelativeVariance = 1e-3;
// The fitted line is used for frames with up to this multiple of the samples of the fitted frames.
// A full frame has 64 times the samples of the coarsest frame that is not sparse
// (FrameQuality::sparse). The first frames of a server have only about 10 000 samples, and their
// time is mostly fixed. Extrapolated to an image of 3840 x 2160 pixels, their line would predict an
// hour.
constexpr double kReach = 100.0;

bool IsPreparation(const scene::StageTime& cost) {
  using scene::FrameStage;
  return cost.stage == FrameStage::kExtinction || cost.stage == FrameStage::kUpload ||
         cost.stage == FrameStage::kFit || cost.stage == FrameStage::kSurface;
}

// Updates the decaying mean of a stage's time. A time of 0 is ignored, because the stage did not
// run.
void Follow(double measured_ms, double* mean_ms) {
  if (measured_ms <= 0.0) return;
  *mean_ms =
      *mean_ms == 0.0 ? measured_ms : kForgetting * *mean_ms + (1.0 - kForgetting) * measured_ms;
}

}  // namespace

double MegaSamples(const scene::Scene& scene, const FrameQuality& quality) {
  // The time of a sparse picture divided by the time of the same picture with one ray per pixel,
  // measured at 1280 x 720 pixels (docs/performance.md). The ratio is larger for smaller pictures;
  // the following frames correct the prediction.
  constexpr double kSparseShare = 0.2;
  const double scale = scene.rendering.image_scale * quality.Scale();
  const double pixels =
      static_cast<double>(scene.output.width_px) * scene.output.height_px * scale * scale;
  return pixels * scene::SamplesPerPixel(scene.rendering.technique, quality.slice_share) * 1e-6 *
         (quality.sparse ? kSparseShare : 1.0);
}

std::optional<double> ViewMs(double total_ms, const std::vector<scene::StageTime>& stages) {
  double other_ms = 0.0;
  bool drew = false;
  for (const scene::StageTime& cost : stages) {
    const bool rare =
        cost.stage == scene::FrameStage::kLight || cost.stage == scene::FrameStage::kCorrection;
    if (rare || IsPreparation(cost)) other_ms += cost.milliseconds;
    drew =
        drew || cost.stage == scene::FrameStage::kSlices || cost.stage == scene::FrameStage::kView;
  }
  if (!drew) return std::nullopt;
  return std::max(0.0, total_ms - other_ms);
}

double CostModel::EstimateMs(double mega_samples, scene::Stage first_dirty) const {
  const double near = std::min(mega_samples, reach_mega_samples_);
  const double drawing_ms =
      first_dirty >= scene::Stage::kTone
          ? 0.0
          : ms_per_mega_sample_ * near + ms_beyond_reach_ * (mega_samples - near);
  const double preparation_ms = first_dirty <= scene::Stage::kExtinction ? preparation_ms_ : 0.0;
  const double light_ms = first_dirty <= scene::Stage::kLight ? light_ms_ : 0.0;
  return fixed_ms_ + drawing_ms + preparation_ms + light_ms;
}

void CostModel::Observe(double mega_samples, double total_ms,
                        const std::vector<scene::StageTime>& stages) {
  double preparation_ms = 0.0;
  double light_ms = 0.0;
  for (const scene::StageTime& cost : stages) {
    if (IsPreparation(cost)) preparation_ms += cost.milliseconds;
    if (cost.stage == scene::FrameStage::kLight) light_ms += cost.milliseconds;
  }
  Follow(preparation_ms, &preparation_ms_);
  Follow(light_ms, &light_ms_);
  const std::optional<double> view_ms = ViewMs(total_ms, stages);
  if (!view_ms.has_value()) return;
  const double y = *view_ms;
  const auto add = [](double& sum, double value) { sum = kForgetting * sum + value; };
  add(weight_, 1.0);
  add(sum_x_, mega_samples);
  add(sum_y_, y);
  add(sum_xx_, mega_samples * mega_samples);
  add(sum_xy_, mega_samples * y);
  Fit();
}

void CostModel::Fit() {
  FitLine();
  reach_mega_samples_ = kReach * std::sqrt(sum_xx_ / weight_);
  // Beyond the reach of the line, the cost is a weighted mean of the frames' own cost and the
  // assumed cost. The assumption has the weight of a frame with a million samples, so it dominates
  // if all frames were much smaller.
  const double mean = (sum_xy_ / weight_ + kUnknownMsPerMegaSample) / (sum_xx_ / weight_ + 1.0);
  ms_beyond_reach_ = std::min(ms_per_mega_sample_, mean);
}

void CostModel::FitLine() {
  const double variance = weight_ * sum_xx_ - sum_x_ * sum_x_;
  if (variance > kMinRelativeVariance * sum_x_ * sum_x_) {
    ms_per_mega_sample_ = (weight_ * sum_xy_ - sum_x_ * sum_y_) / variance;
    fixed_ms_ = (sum_y_ - ms_per_mega_sample_ * sum_x_) / weight_;
    if (ms_per_mega_sample_ > 0.0 && fixed_ms_ >= 0.0) return;
  }
  // All frames had the same number of samples, or noise has made a coefficient negative. The whole
  // time is therefore assumed to be proportional to the number of samples.
  fixed_ms_ = 0.0;
  ms_per_mega_sample_ = sum_xx_ > 0.0 ? sum_xy_ / sum_xx_ : ms_per_mega_sample_;
}

}  // namespace thunderhead::accuracy
