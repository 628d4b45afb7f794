// A scene's picture by the reference, from its fields to pixels. Knows no files.
#pragma once

#include <stop_token>

#include "absl/status/statusor.h"
#include "reference/path_tracer.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::reference {

// The default of MediumOptions::peak_cut_deg for pictures.
inline constexpr double kPeakCut_deg = 3.0;

struct TracedScene {
  picture::LinearPicture image;
  RefineResult result;
};

// What is left out, of use to find out where a picture is wrong.
struct TraceOptions {
  double peak_cut_deg = kPeakCut_deg;  // MediumOptions::peak_cut_deg
  int most_scatterings = 0;            // PathTracerOptions::most_scatterings
  bool sun = true;                     // else the sky alone gives light
};

// The picture that the renderers try to draw: their ground, each field's own phase function or the
// one that the scene's mode gives all.
absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields,
                                       const TraceOptions& options, const RefineLimits& limits,
                                       const ImageObserver& observer, const std::stop_token& stop);
absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields, double peak_cut_deg,
                                       const RefineLimits& limits, const ImageObserver& observer,
                                       const std::stop_token& stop);

}  // namespace thunderhead::reference
