// Converts stored values of a field back to the values in its file. Memory holds masses per volume,
// which are mixing ratios multiplied by the density of air. This code does not depend on files.
#pragma once

#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Returns the quantity in which values of the field can be reported. It is the file's quantity, or
// mass concentration for a mixing ratio of unknown air.
Quantity QuantityOf(const HydrometeorFields& fields, const HydrometeorField& field);

// Returns the value of a cell in the unit of QuantityOf. `cell` must be in the grid. A mixing ratio
// is exact except for the air's density, because that is a mean over the surrounding cells
// (AirDensity). It differs by 1 % in a storm, and by 9 % at worst in an overshooting top.
float ValueAt(const HydrometeorFields& fields, const HydrometeorField& field,
              const glm::ivec3& cell);

// Returns the mass of the field in a volume of air with this sum of concentrations, kg/m3. It is 0
// for a field in extinction.
inline double MassOf(const HydrometeorField& field, double concentration) {
  return field.quantity == Quantity::kExtinction ? 0.0 : concentration;
}

}  // namespace thunderhead::volume
