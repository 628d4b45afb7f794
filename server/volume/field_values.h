// A field's values as its file has them: in memory there are masses per volume, by which mixing
// ratios were multiplied by the density of air. Knows no files.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// The quantity that values of the field can be told in: its own, or mass concentration for a mixing
// ratio of unknown air.
Quantity QuantityOf(const HydrometeorFields& fields, const HydrometeorField& field);

// In the unit of QuantityOf, of one cell. A mixing ratio is exact but for the air's density, which
// differs from its mean over the cells around (AirDensity) by 1 % in a storm, at worst by 9 % in an
// overshooting top. `cell` is one of the grid's.
float ValueAt(const HydrometeorFields& fields, const HydrometeorField& field,
              const glm::ivec3& cell);

// Mass of the field in a volume of air with this much in its concentrations, kg/m3: 0 for a field
// in extinction.
inline double MassOf(const HydrometeorField& field, double concentration) {
  return field.quantity == Quantity::kExtinction ? 0.0 : concentration;
}

}  // namespace thunderhead::volume
