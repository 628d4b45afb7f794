// Predicts the cost of a frame from the costs of earlier frames: milliseconds = a + b pixels x
// slices, fitted by least squares in which older frames count for less, plus the time that
// preparing the fields and carrying the light took when they changed. Plain values, no clock.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "accuracy/frame_quality.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// The size that the cost of drawing `scene` at `quality` grows with: pixels times slices, or times
// the balls or ellipsoids over them, in millions.
double MegaSamples(const scene::Scene& scene, const FrameQuality& quality);

// The part of a frame's `total_ms` from the view on: the cost of a moved camera. None if the frame
// drew no view.
std::optional<double> ViewMs(double total_ms, const std::vector<scene::StageTime>& stages);

class CostModel {
 public:
  // Before anything was measured: between a GPU's 0.1 and a software renderer's 15, so that the
  // first frame is coarse but not the coarsest.
  static constexpr double kUnknownMsPerMegaSample = 2.0;

  // The cost of a frame if `first_dirty` is the first stage to rerun.
  double EstimateMs(double mega_samples, scene::Stage first_dirty) const;

  // A frame of that size took `total_ms`, divided among `stages`. Frames that drew no slices and no
  // view are ignored.
  void Observe(double mega_samples, double total_ms, const std::vector<scene::StageTime>& stages);

 private:
  void Fit();
  void FitLine();

  double weight_ = 0.0;
  double sum_x_ = 0.0;
  double sum_y_ = 0.0;
  double sum_xx_ = 0.0;
  double sum_xy_ = 0.0;
  double fixed_ms_ = 0.0;
  double ms_per_mega_sample_ = kUnknownMsPerMegaSample;
  double reach_mega_samples_ = std::numeric_limits<double>::infinity();
  double ms_beyond_reach_ = kUnknownMsPerMegaSample;
  double preparation_ms_ = 0.0;
  double light_ms_ = 0.0;
};

}  // namespace thunderhead::accuracy
