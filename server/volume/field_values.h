// Converts the stored values of a field back to the values in its file. In memory, mixing ratios
// are multiplied by the density of air and stored as mass per volume. This code does not depend on
// files.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Returns the quantity in which values of the field can be reported. This is the file's quantity,
// except that a mixing ratio is reported as mass concentration if the air's density is unknown.
Quantity QuantityOf(const HydrometeorFields& fields, const HydrometeorField& field);

// Returns the value of a cell in the unit of QuantityOf. `cell` must be in the grid. A mixing ratio
// is approximate, because it is computed with a mean density of the surrounding air (AirDensity).
// Its error is 1 % in a storm, and at most 9 % in an overshooting top.
float ValueAt(const HydrometeorFields& fields, const HydrometeorField& field,
              const glm::ivec3& cell);

// Returns `concentration` (kg/m3), or 0 for a field that the file gives as extinction, whose mass
// is unknown.
inline double MassOf(const HydrometeorField& field, double concentration) {
  return field.quantity == Quantity::kExtinction ? 0.0 : concentration;
}

}  // namespace thunderhead::volume
