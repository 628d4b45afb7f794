// Predicts the cost of a frame from the costs of earlier frames: milliseconds = a + b pixels x
// slices. The fit is a least-squares fit with decaying weights. If the fields or the light changed,
// the time for preparing the fields and propagating the light is added. Plain values, no clock.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "accuracy/frame_quality.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// Returns the size that the cost of drawing `scene` at `quality` grows with, in millions. It is
// pixels times slices, or times the metaballs or ellipsoids over them.
double MegaSamples(const scene::Scene& scene, const FrameQuality& quality);

// Returns the part of a frame's `total_ms` from the view on, which is the cost of a moved camera.
// None if the frame drew no view.
std::optional<double> ViewMs(double total_ms, const std::vector<scene::StageTime>& stages);

class CostModel {
 public:
  // The cost before any measurement. It lies between a GPU's 0.1 and a software renderer's 15, so
  // that the first frame is coarse but not the coarsest.
  static constexpr double kUnknownMsPerMegaSample = 2.0;

  // Returns the predicted cost of a frame if `first_dirty` is the first stage to rerun.
  double EstimateMs(double mega_samples, scene::Stage first_dirty) const;

  // Records that a frame of that size took `total_ms`, divided among `stages`. Frames that drew no
  // slices and no view are ignored.
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
