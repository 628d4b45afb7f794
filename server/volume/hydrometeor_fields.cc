#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

std::string_view UnitOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::kMixingRatio:
      return "kg kg-1";
    case Quantity::kMassConcentration:
      return "kg m-3";
    case Quantity::kExtinction:
      break;
  }
  return "m-1";
}

float MassExtinction_m2_per_kg(const HydrometeorField& field,
                               const physics::ParticleOptics& optics) {
  if (field.quantity == Quantity::kExtinction) return 1.0F;
  return physics::MassExtinction_m2_per_kg(optics.density_kg_per_m3, optics.radius_m);
}

std::size_t HydrometeorFields::Bytes() const {
  std::size_t values = terrain_height_m.capacity();
  for (const HydrometeorField& field : fields) values += field.concentration_kg_per_m3.capacity();
  return values * sizeof(float);
}

}  // namespace thunderhead::volume
