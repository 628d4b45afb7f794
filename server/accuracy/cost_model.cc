#include "accuracy/cost_model.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::accuracy {
namespace {

// The weight of a measurement falls to a third in five frames: fast enough to follow a camera that
// flies into the cloud, slow enough to tell a from b.
constexpr double kForgetting = 0.8;
// Below this variance of x (relative to its mean square) a and b cannot be determined separately.
constexpr double kMinRelativeVariance = 1e-3;
// Sizes that differ by a tenth of a million samples say as much as what is supposed before anything
// was measured; frames of one size, of one million. The pictures that a server draws at its start
// are far smaller, and mostly fixed cost: by them alone a still of 3840 x 2160 would take an hour.
constexpr double kSizeNoise = 0.01;
constexpr double kUnknown = CostModel::kUnknownMsPerMegaSample;

bool IsPreparation(const scene::StageTime& cost) {
  using scene::FrameStage;
  return cost.stage == FrameStage::kExtinction || cost.stage == FrameStage::kUpload ||
         cost.stage == FrameStage::kFit || cost.stage == FrameStage::kSurface;
}

// Moves `mean` towards a measurement of a stage that ran.
void Follow(double measured_ms, double* mean_ms) {
  if (measured_ms <= 0.0) return;
  *mean_ms =
      *mean_ms == 0.0 ? measured_ms : kForgetting * *mean_ms + (1.0 - kForgetting) * measured_ms;
}

}  // namespace

double MegaSamples(const scene::Scene& scene, const FrameQuality& quality) {
  // Of a sparse picture's whole time over that with a ray for each pixel, as measured at 1280 x 720
  // (docs/performance.md); a smaller picture takes more, which is learnt from the next frames.
  constexpr double kSparseShare = 0.3;
  const double scale = scene.rendering.image_scale * quality.image_scale;
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
  const double drawing_ms =
      first_dirty >= scene::Stage::kTone ? 0.0 : ms_per_mega_sample_ * mega_samples;
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
  const double mean_x = sum_x_ / weight_;
  const double mean_y = sum_y_ / weight_;
  const double variance = sum_xx_ / weight_ - mean_x * mean_x;
  if (variance > kMinRelativeVariance * mean_x * mean_x) {
    const double covariance = sum_xy_ / weight_ - mean_x * mean_y;
    SetLine((covariance + kSizeNoise * kUnknown) / (variance + kSizeNoise), mean_x, mean_y);
    if (ms_per_mega_sample_ > 0.0 && fixed_ms_ >= 0.0) return;
  }
  // Frames of one size, or a fit that noise has bent below zero: nearly all of the cost grows with
  // the size, unless they are so small that they say nothing of larger ones.
  SetLine((sum_xy_ / weight_ + kUnknown) / (sum_xx_ / weight_ + 1.0), mean_x, mean_y);
  if (fixed_ms_ >= 0.0) return;
  fixed_ms_ = 0.0;
  ms_per_mega_sample_ = sum_xx_ > 0.0 ? sum_xy_ / sum_xx_ : ms_per_mega_sample_;
}

void CostModel::SetLine(double slope, double mean_x, double mean_y) {
  ms_per_mega_sample_ = slope;
  fixed_ms_ = mean_y - slope * mean_x;
}

}  // namespace thunderhead::accuracy
