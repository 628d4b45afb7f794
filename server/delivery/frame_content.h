// Descriptions of what a frame shows and how it was drawn. They are plain values that are sent with
// the frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "accuracy/accuracy_report.h"
#include "renderers/content.h"
#include "scene/frame_stage.h"

namespace thunderhead::delivery {

using accuracy::AccuracyReport;
using scene::StageTime;

// The content of a frame and the technique that drew it.
struct Modelled {
  std::string technique;  // name of the technique
  renderers::Content content;
  int slices = 0;
  std::uint64_t device_bytes = 0;
  std::int64_t traced_paths = 0;  // number of traced paths that corrected the light
  double exposure_ev = 0.0;
};

// Progress of a picture that the Monte Carlo reference refines.
struct Refinement {
  int samples_per_pixel = 0;  // number of samples of each pixel
  // Root mean square of the pixels' standard errors, divided by their mean radiance. Absent if the
  // pixels have too few samples to estimate it.
  std::optional<double> relative_error;

  bool operator==(const Refinement&) const = default;
};

}  // namespace thunderhead::delivery
