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

MassExtinction MassExtinctionOf(const HydrometeorField& field,
                                const physics::ParticleOptics& optics, bool size_from_file) {
  if (field.quantity == Quantity::kExtinction) return {1.0F, false};
  const bool by_cell = size_from_file && !field.sizes.Empty();
  const float radius_m = by_cell ? 1.0F : optics.radius_m;
  return {physics::MassExtinction_m2_per_kg(optics.density_kg_per_m3, radius_m), by_cell};
}

void AddExtinction(const HydrometeorField& field, const MassExtinction& mass_extinction,
                   std::size_t offset, std::size_t count, float* sums, std::size_t stride) {
  const float* concentration = field.concentration_kg_per_m3.data() + offset;
  const float weight = mass_extinction.m2_per_kg;
  if (!mass_extinction.by_cell) {
    for (std::size_t i = 0; i < count; ++i) sums[i * stride] += concentration[i] * weight;
    return;
  }
  const std::uint16_t* inverse_radius = field.sizes.inverse_radius.data() + offset;
  for (std::size_t i = 0; i < count; ++i) {
    sums[i * stride] += concentration[i] * weight * InverseRadius_per_m(inverse_radius[i]);
  }
}

physics::ParticleOptics WithDrawnRadius(const HydrometeorField& field,
                                        physics::ParticleOptics optics, bool size_from_file) {
  if (size_from_file && field.sizes.mean_radius_m > 0.0F) {
    optics.radius_m = field.sizes.mean_radius_m;
  }
  return optics;
}

std::size_t HydrometeorFields::Bytes() const {
  std::size_t values = terrain_height_m.capacity();
  std::size_t halves = 0;
  for (const HydrometeorField& field : fields) {
    values += field.concentration_kg_per_m3.capacity();
    halves += field.sizes.inverse_radius.capacity();
  }
  return values * sizeof(float) + halves * sizeof(std::uint16_t);
}

}  // namespace thunderhead::volume
