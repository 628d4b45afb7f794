#include "scene/scene.h"

#include <algorithm>

namespace thunderhead::scene {
namespace {

bool SameOptics(const physics::ParticleOptics& a, const physics::ParticleOptics& b) {
  return a.radius_m == b.radius_m && a.density_kg_per_m3 == b.density_kg_per_m3 &&
         a.albedo == b.albedo && a.phase == b.phase && a.false_color == b.false_color;
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

}  // namespace thunderhead::scene
