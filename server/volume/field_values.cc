#include "volume/field_values.h"

namespace thunderhead::volume {

Quantity QuantityOf(const HydrometeorFields& fields, const HydrometeorField& field) {
  const bool unknown_air = field.quantity == Quantity::kMixingRatio && fields.air.Empty();
  return unknown_air ? Quantity::kMassConcentration : field.quantity;
}

float ValueAt(const HydrometeorFields& fields, const HydrometeorField& field,
              const glm::ivec3& cell) {
  if (field.concentration_kg_per_m3.empty()) return 0.0F;
  const float concentration =
      field.concentration_kg_per_m3[fields.grid.Offset(cell.x, cell.y, cell.z)];
  if (concentration == 0.0F || QuantityOf(fields, field) != Quantity::kMixingRatio) {
    return concentration;
  }
  return concentration / fields.air.At(fields.grid, cell.x, cell.y, cell.z);
}

}  // namespace thunderhead::volume
