#include "scene/scene.h"

namespace thunderhead::scene {
namespace {

bool SameOptics(const physics::ParticleOptics& a, const physics::ParticleOptics& b) {
  return a.radius_m == b.radius_m && a.density_kg_per_m3 == b.density_kg_per_m3 &&
         a.albedo == b.albedo && a.phase == b.phase && a.false_color == b.false_color;
}

}  // namespace

bool FieldParameters::operator==(const FieldParameters& other) const {
  return visible == other.visible && scale == other.scale && SameOptics(optics, other.optics);
}

Scene::Scene() {
  for (physics::Hydrometeor hydrometeor : physics::kHydrometeors) {
    fields[physics::IndexOf(hydrometeor)].optics = physics::DefaultOptics(hydrometeor);
  }
}

Stage FirstDirtyStage(const Scene& before, const Scene& after) {
  if (before.storm_id != after.storm_id || before.time_index != after.time_index) {
    return Stage::kStorm;
  }
  const bool grouping_changed = before.rendering.mode != after.rendering.mode ||
                                before.rendering.false_colors != after.rendering.false_colors;
  if (before.fields != after.fields || grouping_changed) return Stage::kExtinction;
  if (before.sun != after.sun || before.rendering != after.rendering) return Stage::kLight;
  const bool same_size = before.output.width_px == after.output.width_px &&
                         before.output.height_px == after.output.height_px;
  if (before.camera != after.camera || before.sky != after.sky || !same_size) return Stage::kView;
  if (before.display != after.display || before.output != after.output) return Stage::kTone;
  return Stage::kNothing;
}

}  // namespace thunderhead::scene
