#include "volume/hydrometeor_fields.h"

#include <algorithm>

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
                                const physics::ParticleOptics& optics, physics::SizeSource sizes) {
  if (field.quantity == Quantity::kExtinction) return {1.0F, false};
  const bool by_cell = sizes == physics::SizeSource::kModel && !field.sizes.Empty();
  const float radius_m =
      by_cell ? 1.0F : physics::ConstantRadius_m(field.hydrometeor, sizes, optics.radius_m);
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
  // Cells outside the range with sizes are empty.
  const std::size_t low = std::max(offset, field.sizes.first_cell);
  const std::size_t high = std::min(offset + count, field.sizes.EndCell());
  for (std::size_t cell = low; cell < high; ++cell) {
    const std::size_t i = cell - offset;
    sums[i * stride] += concentration[i] * weight * InverseRadius_per_m(field.sizes, cell);
  }
}

std::vector<float> ConcentrationPerRadius(const HydrometeorField& field) {
  std::vector<float> per_radius(field.concentration_kg_per_m3.size(), 0.0F);
  AddExtinction(field, {1.0F, true}, 0, per_radius.size(), per_radius.data());
  return per_radius;
}

physics::ParticleOptics WithDrawnRadius(const HydrometeorField& field,
                                        physics::ParticleOptics optics, physics::SizeSource sizes) {
  const bool by_cell = sizes == physics::SizeSource::kModel && field.sizes.mean_radius_m > 0.0F;
  optics.radius_m = by_cell ? field.sizes.mean_radius_m
                            : physics::ConstantRadius_m(field.hydrometeor, sizes, optics.radius_m);
  return optics;
}

std::size_t HydrometeorFields::Bytes() const {
  std::size_t values = terrain_height_m.capacity() + air.kg_per_m3.capacity();
  std::size_t halves = 0;
  for (const HydrometeorField& field : fields) {
    values += field.concentration_kg_per_m3.capacity();
    halves += field.sizes.inverse_radius.capacity();
  }
  return values * sizeof(float) + halves * sizeof(std::uint16_t) +
         land.texels.capacity() * sizeof(glm::u8vec4) + motion.turbulence.capacity() +
         motion.ascent.capacity() + (borders != nullptr ? borders->Bytes() : 0);
}

}  // namespace thunderhead::volume
