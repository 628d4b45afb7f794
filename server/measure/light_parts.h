// Parts of the light, used to find out which part a renderer computes wrongly. A part is the same
// scene with fewer light sources, or with single scattering only. It is drawn by the renderer and
// traced by the path-traced reference. The functions use GL, so call them on the context's thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "measure/image_error.h"
#include "reference/trace_scene.h"
#include "renderers/scene_renderer.h"
#include "scene/scene.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::measure {

enum class LightPart {
  // Sunlight scattered once, with the same phase function for all fields and with black sky and
  // ground. Renderer and reference are both exact.
  kOnce,
  kSun,  // sunlight scattered any number of times, black sky and ground
  kSky,  // only skylight, black ground
  kAll
};

std::string NameOf(LightPart part);

// Return the scene that the reference traces for `part` of `scene`, and the options of its tracing.
scene::Scene SceneOf(LightPart part, scene::Scene scene);
reference::TraceOptions TraceOptionsOf(LightPart part, double peak_cut_deg);

// Draws one part with `scene`'s technique and transport, at `finer` times its width and height.
// Then it averages blocks of `finer` x `finer` pixels, because the reference also averages over a
// pixel. `correction` may be null.
absl::StatusOr<picture::LinearPicture> DrawPart(
    renderers::SceneRenderer& renderer, const scene::Scene& scene,
    const std::shared_ptr<const volume::HydrometeorFields>& fields, LightPart part, int finer,
    std::shared_ptr<const renderers::LightCorrection> correction);

}  // namespace thunderhead::measure
