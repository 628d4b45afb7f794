// Converts the mixing ratios of a file into mass per volume of air, and collects statistics about
// them.
#pragma once

#include <vector>

#include "storm_files/layer_air.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Replaces mixing ratios (kg per kg of dry air, NaN where missing) by concentrations (kg/m3), in
// place. Negative and missing values become zero and are counted.
volume::FieldStatistics MixingRatioToConcentration(const LayerAir& air, std::vector<float>& values);

// Returns the smallest box of cells with condensate. Sets subnormal values to zero.
volume::CellBox FlushAndBound(const volume::RegularGrid& grid,
                              std::vector<float>& concentration_kg_per_m3);

// Returns the smallest box that contains both.
volume::CellBox Union(const volume::CellBox& a, const volume::CellBox& b);

}  // namespace thunderhead::storm_files
