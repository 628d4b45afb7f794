#include "scene/scene.h"

#include <algorithm>

namespace thunderhead::scene {
namespace {

bool SameOptics(const physics::ParticleOptics& a, const physics::ParticleOptics& b) {
  return a.radius_m == b.radius_m && a.density_kg_per_m3 == b.density_kg_per_m3 &&
         a.albedo == b.albedo && a.phase == b.phase && a.false_color == b.false_color;
}

// The fields as they are drawn: without the detail that the mode ignores.
std::array<FieldParameters, physics::kHydrometeorCount> DrawnFields(const Scene& scene) {
  auto fields = scene.fields;
  if (HasDetail(scene.rendering.mode)) return fields;
  for (FieldParameters& field : fields) field.detail = {};
  return fields;
}

bool BothCumulus(const Rendering& before, const Rendering& after) {
  return before.renderer == Renderer::kCumulus && after.renderer == Renderer::kCumulus;
}

// The cumulus renderer draws a surface, all others a medium; each is made in the other's place.
bool SameContent(const Rendering& before, const Rendering& after) {
  if (BothCumulus(before, after)) {
    const Cumulus& a = before.cumulus;
    const Cumulus& b = after.cumulus;
    return a.source == b.source && a.seed == b.seed && a.scales == b.scales &&
           a.least_extinction_per_m == b.least_extinction_per_m;
  }
  if (before.renderer == Renderer::kCumulus || after.renderer == Renderer::kCumulus) return false;
  return before.mode == after.mode && before.false_colors == after.false_colors;
}

// A surface shades what lies behind it, less its corona; the rest of its shading is the view's.
bool SameLight(Rendering before, const Rendering& after) {
  if (BothCumulus(before, after)) return before.cumulus.corona == after.cumulus.corona;
  before.cumulus = after.cumulus;
  before.traced_light = after.traced_light;
  return before == after;
}

// What a change of the lights besides the sun dirties: their colours count once the light is
// carried; where they are not shown, a frame only says so.
Stage DirtiedByLights(const Scene& before, const Scene& after) {
  if (before.lights == after.lights) return Stage::kNothing;
  if (!ShowsLights(after.rendering.renderer)) return Stage::kTone;
  const bool same_directions =
      std::equal(before.lights.begin(), before.lights.end(), after.lights.begin(),
                 after.lights.end(), [](const DirectionalLight& a, const DirectionalLight& b) {
                   return a.azimuth_deg == b.azimuth_deg && a.elevation_deg == b.elevation_deg;
                 });
  return same_directions ? Stage::kView : Stage::kLight;
}

Stage DirtiedByTheRest(const Scene& before, const Scene& after) {
  const bool same_size = before.output.width_px == after.output.width_px &&
                         before.output.height_px == after.output.height_px;
  if (before.camera != after.camera || before.sky != after.sky || !same_size ||
      before.rendering.traced_light != after.rendering.traced_light ||
      (BothCumulus(before.rendering, after.rendering) &&
       before.rendering.cumulus != after.rendering.cumulus)) {
    return Stage::kView;
  }
  if (before.display != after.display || before.output != after.output) return Stage::kTone;
  return Stage::kNothing;
}

}  // namespace

bool FieldParameters::operator==(const FieldParameters& other) const {
  return visible == other.visible && scale == other.scale && SameOptics(optics, other.optics) &&
         size_from_file == other.size_from_file && detail == other.detail;
}

Detail DefaultDetail(physics::Hydrometeor hydrometeor) {
  // One seed and wavelength for all, as one turbulent flow carries them all: the noise is then
  // fetched once. Equal shares leave fields that scatter alike in one group.
  const bool water =
      hydrometeor == physics::Hydrometeor::kCloud || hydrometeor == physics::Hydrometeor::kRain;
  // A cell of cloud water is opaque: what was left of its even part would hide the rest.
  return {.share = water ? 1.0F : 0.8F};
}

float DefaultDetailWavelength_m(const glm::dvec3& cell_m) {
  return kDetailWavelengthInCells * static_cast<float>(std::max(cell_m.x, cell_m.y));
}

Detail DrawnDetail(const Scene& scene, physics::Hydrometeor hydrometeor, const glm::dvec3& cell_m) {
  Detail detail = scene.fields[physics::IndexOf(hydrometeor)].detail;
  if (!HasDetail(scene.rendering.mode) || detail.share <= 0.0F) return {};
  if (detail.wavelength_m <= 0.0F) detail.wavelength_m = DefaultDetailWavelength_m(cell_m);
  return detail;
}

bool HasPerFieldPhase(Mode mode) {
  return mode == Mode::kPerFieldPhaseTranslucent || mode == Mode::kPerFieldPhaseDetailTranslucent;
}

bool HasDetail(Mode mode) { return mode == Mode::kPerFieldPhaseDetailTranslucent; }

bool ShowsLights(Renderer renderer) {
  return renderer == Renderer::kMetaball || renderer == Renderer::kReference;
}

bool ShowsTracedLight(const Rendering& rendering) {
  return rendering.renderer == Renderer::kLightVolume &&
         rendering.transport == Transport::kDiffusion &&
         rendering.mode != Mode::kUniformPhaseLowAlbedo;
}

Scene::Scene() {
  for (physics::Hydrometeor hydrometeor : physics::kHydrometeors) {
    FieldParameters& field = fields[physics::IndexOf(hydrometeor)];
    field.optics = physics::DefaultOptics(hydrometeor);
    field.detail = DefaultDetail(hydrometeor);
  }
}

Stage FirstDirtyStage(const Scene& before, const Scene& after) {
  if (before.storm_id != after.storm_id || before.time_index != after.time_index) {
    return Stage::kStorm;
  }
  if (DrawnFields(before) != DrawnFields(after) ||
      !SameContent(before.rendering, after.rendering)) {
    return Stage::kExtinction;
  }
  if (before.sun != after.sun || !SameLight(before.rendering, after.rendering)) {
    return Stage::kLight;
  }
  return std::min(DirtiedByLights(before, after), DirtiedByTheRest(before, after));
}

}  // namespace thunderhead::scene
