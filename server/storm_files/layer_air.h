// The heights of a WRF file's layers and the density of dry air in them.
#pragma once

#include <cstddef>
#include <vector>

namespace thunderhead::storm_files {

// All arrays have x running fastest, then y, then levels upwards.
struct LayerAir {
  int levels = 0;
  std::size_t columns = 0;
  std::vector<float> interface_height_m;         // (levels + 1) * columns; NaN where missing
  std::vector<float> dry_air_density_kg_per_m3;  // levels * columns; NaN where an input is missing
  std::vector<float> temperature_K;              // levels * columns; empty if no field needs it
};

// Computes heights from the sum of perturbation and base geopotential (m2/s2), in place.
// Implausible heights become NaN.
void GeopotentialToHeight(const std::vector<float>& base, std::vector<float>& geopotential);

// The state of the air in each layer, as the file gives it. Missing values are NaN.
struct LayerState {
  std::vector<float> pressure_Pa;
  std::vector<float> potential_temperature_K;
  std::vector<float> vapour_kg_per_kg;  // empty if the air is dry
};

// Returns the temperature of every layer. It is meaningless where the density is NaN.
std::vector<float> Temperature(const LayerState& state);

// Returns the density of dry air in every layer. Reuses the memory of `state.pressure_Pa`. The
// density of a layer with missing or unordered interfaces is NaN.
std::vector<float> DryAirDensity(LayerState state, const std::vector<float>& interface_height_m,
                                 std::size_t columns);

}  // namespace thunderhead::storm_files
