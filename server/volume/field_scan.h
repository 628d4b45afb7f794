// Converts a mixing ratio from a file into mass per volume of air, with statistics.
#pragma once

#include <vector>

#include "volume/hydrometeor_fields.h"
#include "volume/layer_air.h"

namespace thunderhead::volume {

// Replaces mixing ratios (kg per kg of dry air, NaN where missing) by concentrations (kg/m3), in
// place: negatives and missing cells become zero, and are counted.
FieldStatistics MixingRatioToConcentration(const LayerAir& air, std::vector<float>& values);

// The smallest box of cells with condensate; sets subnormal values to zero.
CellBox FlushAndBound(const RegularGrid& grid, std::vector<float>& concentration_kg_per_m3);

// The smallest box that contains both.
CellBox Union(const CellBox& a, const CellBox& b);

}  // namespace thunderhead::volume
