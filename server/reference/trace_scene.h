// Traces a scene's picture, from its fields to pixels. This code does not use files.
#pragma once

#include <stop_token>

#include "absl/status/statusor.h"
#include "reference/path_tracer.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::reference {

// The default of MediumOptions::peak_cut_deg for pictures of scenes.
inline constexpr double kPeakCut_deg = 3.0;

struct TracedScene {
  picture::LinearPicture image;
  RefineResult result;
};

// Options that omit parts of the light, for finding the cause of a picture's error.
struct TraceOptions {
  double peak_cut_deg = kPeakCut_deg;  // MediumOptions::peak_cut_deg
  int max_scatterings = 0;             // PathTracerOptions::max_scatterings
  bool sun = true;                     // if false, only the sky gives light
  // If false, there is no air. The sky is then black, and the sun has its irradiance above the
  // atmosphere. The ground stays.
  bool air = true;
  int detail_voxels_per_cell = 0;  // MediumOptions::detail_voxels_per_cell
};

// Path-traces the picture of a scene that renderers approximate, with the ground that the renderers
// draw. The scene's technique decides whether each field has its own phase function or all fields
// have the same one.
absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields,
                                       const TraceOptions& options, const RefineLimits& limits,
                                       const ImageObserver& observer, const std::stop_token& stop);
absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields, double peak_cut_deg,
                                       const RefineLimits& limits, const ImageObserver& observer,
                                       const std::stop_token& stop);

}  // namespace thunderhead::reference
