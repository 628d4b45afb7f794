// Converts the amounts of a file into mass per volume of air, and collects statistics about them.
#pragma once

#include <vector>

#include "storm_files/layer_air.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::storm_files {

// Replaces amounts (NaN where missing) by concentrations (kg/m3), in place. `density_kg_per_m3` is
// the density of the air of which the amounts are a share. It is empty if the amounts are already
// per volume. Negative and missing values become zero and are counted.
volume::FieldStatistics AmountToConcentration(const LayerAir& air,
                                              const std::vector<float>& density_kg_per_m3,
                                              std::vector<float>& values);

// Returns the share of the amounts in layers above the ground that are in cells without a density,
// because their air is missing or impossible. It is 0 if no such layer has an amount above 0.
double ShareWithoutAir(const LayerAir& air, const std::vector<float>& density_kg_per_m3,
                       const std::vector<float>& amounts);

// Returns the smallest box of cells with condensate. Sets subnormal values to zero.
volume::CellBox FlushAndBound(const volume::RegularGrid& grid,
                              std::vector<float>& concentration_kg_per_m3);

// Returns the smallest box that contains both.
volume::CellBox Union(const volume::CellBox& a, const volume::CellBox& b);

}  // namespace thunderhead::storm_files
