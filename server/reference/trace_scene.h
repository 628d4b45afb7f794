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
  Image image;
  RefineResult result;
};

// The picture that the renderers try to draw: their ground, each field's own phase function or the
// one that the scene's mode gives all.
absl::StatusOr<TracedScene> TraceScene(const scene::Scene& scene,
                                       const volume::HydrometeorFields& fields, double peak_cut_deg,
                                       const RefineLimits& limits, const ImageObserver& observer,
                                       const std::stop_token& stop);

}  // namespace thunderhead::reference
