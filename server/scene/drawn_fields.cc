#include "scene/drawn_fields.h"

#include "physics/optics.h"

namespace thunderhead::scene {
namespace {

// Returns the phase function with which a field is drawn. The radius in `optics` must be the drawn
// radius. If the technique has one phase function for every field, it is that of cloud water.
physics::PhaseFunction PhaseShown(const Scene& scene, const physics::ParticleOptics& optics,
                                  const FieldLook& look) {
  if (look.per_field_phase) return physics::PhaseOf(optics);
  return physics::PhaseOf(scene.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].optics);
}

}  // namespace

bool IsDrawn(const Scene& scene, const volume::HydrometeorField& field) {
  const FieldParameters& look = scene.fields[physics::IndexOf(field.hydrometeor)];
  return look.visible && look.scale > 0.0F && !field.concentration_kg_per_m3.empty();
}

std::vector<DrawnField> DrawnFieldsOf(const Scene& scene, const volume::HydrometeorFields& fields) {
  const FieldLook look = FieldLookOf(scene.rendering.technique);
  std::vector<DrawnField> drawn;
  for (std::size_t i = 0; i < fields.fields.size(); ++i) {
    const volume::HydrometeorField& field = fields.fields[i];
    if (!IsDrawn(scene, field)) continue;
    const FieldParameters& parameters = scene.fields[physics::IndexOf(field.hydrometeor)];
    const physics::ParticleOptics optics =
        volume::WithDrawnRadius(field, parameters.optics, parameters.sizes);
    DrawnField entry;
    entry.index = i;
    entry.hydrometeor = field.hydrometeor;
    entry.mass_extinction = volume::MassExtinctionOf(field, parameters.optics, parameters.sizes);
    entry.mass_extinction.m2_per_kg *= parameters.scale;
    if (field.quantity != volume::Quantity::kExtinction) entry.radius_m = optics.radius_m;
    entry.sizes = parameters.sizes;
    entry.albedo = optics.albedo;
    entry.phase = PhaseShown(scene, optics, look);
    if (look.false_colors) entry.color = optics.false_color;
    entry.asked_detail = parameters.detail;
    entry.detail = DrawnDetail(scene, field.hydrometeor, fields.grid.spacing_m);
    drawn.push_back(entry);
  }
  return drawn;
}

std::vector<physics::Hydrometeor> HydrometeorsOf(const std::vector<DrawnField>& drawn) {
  std::vector<physics::Hydrometeor> hydrometeors;
  hydrometeors.reserve(drawn.size());
  for (const DrawnField& field : drawn) hydrometeors.push_back(field.hydrometeor);
  return hydrometeors;
}

}  // namespace thunderhead::scene
