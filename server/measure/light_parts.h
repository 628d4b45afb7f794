// Parts of the light, to find which part a renderer gets wrong. A part is the same scene with fewer
// light sources, or with single scattering only, for the renderer and the reference alike. Owns GL
// objects: use it on the context's thread.
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
  kOnce,  // sunlight scattered once, uniform phase, black sky and ground: both sides are exact
  kSun,   // sunlight scattered any number of times, black sky and ground
  kSky,   // only skylight, black ground
  kAll
};

std::string NameOf(LightPart part);

// Return the scene that the reference traces for that part of `scene`, and its options.
scene::Scene SceneOf(LightPart part, scene::Scene scene);
reference::TraceOptions TraceOptionsOf(LightPart part, double peak_cut_deg);

// Draws one part with `scene`'s renderer and transport, at `finer` times its width and height.
// Averages blocks of pixels, because the reference averages over a pixel. `correction` may be null.
absl::StatusOr<picture::LinearPicture> DrawPart(
    renderers::SceneRenderer& renderer, const scene::Scene& scene,
    const std::shared_ptr<const volume::HydrometeorFields>& fields, LightPart part, int finer,
    std::shared_ptr<const renderers::LightCorrection> correction);

}  // namespace thunderhead::measure
