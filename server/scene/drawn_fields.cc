#include "scene/drawn_fields.h"

namespace thunderhead::scene {

bool IsDrawn(const Scene& scene, const volume::HydrometeorField& field) {
  const FieldParameters& look = scene.fields[physics::IndexOf(field.hydrometeor)];
  return look.visible && look.scale > 0.0F && !field.concentration_kg_per_m3.empty();
}

}  // namespace thunderhead::scene
