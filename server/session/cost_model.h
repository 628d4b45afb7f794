// Foretells what a frame will cost from what frames have cost: milliseconds = a + b pixels x
// slices, fitted by least squares in which older frames count for less, plus what preparing the
// fields and carrying the light cost when they changed. Plain values, no clock.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "scene/scene.h"
#include "session/frame_source.h"

namespace thunderhead::session {

// What drawing `scene` at `quality` grows with: pixels times slices, or times the balls or
// ellipsoids over them, in millions.
double MegaSamples(const scene::Scene& scene, const FrameQuality& quality);

// What the view and all after it took of a frame's `total_ms`: what a moved camera costs. None if
// the frame drew no view.
std::optional<double> ViewMs(double total_ms, const std::vector<StageCost>& stages);

class CostModel {
 public:
  // What the frame will cost if `first_dirty` is the first stage to rerun.
  double EstimateMs(double mega_samples, scene::Stage first_dirty) const;

  // A frame of that size took `total_ms`, of which `stages` say what they tell apart. Frames that
  // drew no slices and no view teach nothing.
  void Observe(double mega_samples, double total_ms, const std::vector<StageCost>& stages);

 private:
  void Fit();

  double weight_ = 0.0;
  double sum_x_ = 0.0;
  double sum_y_ = 0.0;
  double sum_xx_ = 0.0;
  double sum_xy_ = 0.0;
  double fixed_ms_ = 0.0;
  // Before anything was measured: between a GPU's 0.1 and a software renderer's 15, so that the
  // first frame is coarse but not the coarsest.
  double ms_per_mega_sample_ = 2.0;
  double preparation_ms_ = 0.0;
  double light_ms_ = 0.0;
};

// One for each renderer: what they cost has nothing in common.
class CostModels {
 public:
  CostModel& Of(const scene::Scene& scene) { return models_[IndexOf(scene)]; }
  const CostModel& Of(const scene::Scene& scene) const { return models_[IndexOf(scene)]; }

 private:
  static std::size_t IndexOf(const scene::Scene& scene) {
    return static_cast<std::size_t>(scene.rendering.renderer);
  }
  std::array<CostModel, scene::kRendererCount> models_;
};

}  // namespace thunderhead::session
