// Predicts the time of a frame from the times of earlier frames, as a + b (pixels x slices)
// milliseconds. The coefficients are found by least squares, and older frames have smaller weights.
// If the fields or the light have changed, the times for preparing the fields and propagating the
// light are added. The class uses no clock.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "accuracy/frame_quality.h"
#include "scene/frame_stage.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// Returns the number of samples, in millions, to which the time of drawing `scene` at `quality` is
// proportional. It is the number of pixels times the number of slices, or times the number of
// metaballs or ellipsoids that cover them.
double MegaSamples(const scene::Scene& scene, const FrameQuality& quality);

// Returns the part of a frame's `total_ms` that must be repeated if only the camera moves: the view
// stage and all later stages. Returns nothing if the frame did not run the view stage.
std::optional<double> ViewMs(double total_ms, const std::vector<scene::StageTime>& stages);

class CostModel {
 public:
  // The assumed milliseconds per million samples before any measurement. The value lies between 0.1
  // ms of a GPU and 15 ms of a software renderer, so that the first frame has a medium quality.
  static constexpr double kUnknownMsPerMegaSample = 2.0;

  // Returns the predicted milliseconds of a frame with that number of samples. `first_dirty` is the
  // first stage that must be run again.
  double EstimateMs(double mega_samples, scene::Stage first_dirty) const;

  // Records that a frame with that number of samples took `total_ms`, of which `stages` gives the
  // parts. A frame that drew neither slices nor a view updates only the times for preparing the
  // fields and propagating the light.
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
