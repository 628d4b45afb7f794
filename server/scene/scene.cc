#include "scene/scene.h"

#include <algorithm>

namespace thunderhead::scene {
namespace {

bool SameOptics(const physics::ParticleOptics& a, const physics::ParticleOptics& b) {
  return a.radius_m == b.radius_m && a.density_kg_per_m3 == b.density_kg_per_m3 &&
         a.albedo == b.albedo && a.phase == b.phase && a.false_color == b.false_color;
}

// Returns the fields as they are drawn, without the detail that the technique ignores.
std::array<FieldParameters, physics::kHydrometeorCount> FieldsShown(const Scene& scene) {
  auto fields = scene.fields;
  const Technique& technique = scene.rendering.technique;
  const bool roughens = CapabilitiesOf(technique).detail == DetailUse::kRoughness;
  if (roughens || FieldLookOf(technique).detail) return fields;
  for (FieldParameters& field : fields) field.detail = {};
  return fields;
}

// Returns the first stage that a change of the additional lights dirties. The view stage multiplies
// the lights' colours with the light computed before. A technique that does not show the lights
// only reports them as not shown.
Stage DirtiedByLights(const Scene& before, const Scene& after) {
  if (before.lights == after.lights) return Stage::kNothing;
  if (!CapabilitiesOf(after.rendering.technique).lights) return Stage::kTone;
  const bool same_directions =
      std::equal(before.lights.begin(), before.lights.end(), after.lights.begin(),
                 after.lights.end(), [](const DirectionalLight& a, const DirectionalLight& b) {
                   return a.azimuth_deg == b.azimuth_deg && a.elevation_deg == b.elevation_deg;
                 });
  // Only for the built-in techniques is it known that they apply the colours in the view stage.
  const bool own = !std::holds_alternative<OtherTechnique>(after.rendering.technique);
  return same_directions && own ? Stage::kView : Stage::kLight;
}

Stage DirtiedByTheRest(const Scene& before, const Scene& after) {
  const bool same_size = before.output.width_px == after.output.width_px &&
                         before.output.height_px == after.output.height_px;
  // Diffusion uses the ground's light as a boundary condition. The shares of sun and sky and the
  // ground's albedo therefore change the storm's light.
  const MediumSettings* medium = MediumSettingsOf(after.rendering.technique);
  const bool diffuses = medium != nullptr && medium->transport == Transport::kDiffusion;
  // Borders and rings do not change the ground's albedo.
  const bool same_cover = before.ground.cover == after.ground.cover;
  if (diffuses && (before.sky != after.sky || !same_cover)) return Stage::kLight;
  if (before.camera != after.camera || before.sky != after.sky || before.ground != after.ground ||
      !same_size) {
    return Stage::kView;
  }
  if (before.display != after.display || before.output != after.output) return Stage::kTone;
  return Stage::kNothing;
}

}  // namespace

bool FieldParameters::operator==(const FieldParameters& other) const {
  return visible == other.visible && scale == other.scale && SameOptics(optics, other.optics) &&
         sizes == other.sizes && detail == other.detail;
}

Detail DefaultDetail(physics::Hydrometeor hydrometeor) {
  // All fields have the same seed and wavelength, because one turbulent flow carries them all. The
  // noise then has to be fetched only once. Equal shares keep fields with equal optics in one
  // group. Rain has no detail because it falls through the eddies.
  return {.share = hydrometeor == physics::Hydrometeor::kRain ? 0.0F : 1.0F};
}

float DefaultDetailWavelength_m(const glm::dvec3& cell_m) {
  return kDetailWavelengthInCells * static_cast<float>(std::max(cell_m.x, cell_m.y));
}

Detail DrawnDetail(const Scene& scene, physics::Hydrometeor hydrometeor, const glm::dvec3& cell_m) {
  Detail detail = scene.fields[physics::IndexOf(hydrometeor)].detail;
  if (!FieldLookOf(scene.rendering.technique).detail || detail.share <= 0.0F) return {};
  if (detail.wavelength_m <= 0.0F) detail.wavelength_m = DefaultDetailWavelength_m(cell_m);
  return detail;
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
  if (FieldsShown(before) != FieldsShown(after)) return Stage::kExtinction;
  Stage first = FirstDirtyStage(before.rendering.technique, after.rendering.technique);
  if (before.sun != after.sun || before.rendering.image_scale != after.rendering.image_scale) {
    first = std::min(first, Stage::kLight);
  }
  return std::min({first, DirtiedByLights(before, after), DirtiedByTheRest(before, after)});
}

}  // namespace thunderhead::scene
