// The heights of a model's layers and the density of the air in them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace thunderhead::storm_files {

// All arrays have x running fastest, then y, then levels upwards.
struct LayerAir {
  int levels = 0;
  std::size_t columns = 0;
  std::vector<float> interface_height_m;         // (levels + 1) * columns; NaN where missing
  std::vector<float> dry_air_density_kg_per_m3;  // levels * columns; NaN where an input is missing
  // The density of dry air, vapour and condensate together. Empty if no field needs it.
  std::vector<float> whole_air_density_kg_per_m3;
  std::vector<float> temperature_K;  // levels * columns; empty if no field needs it
};

// Computes heights from the sum of perturbation and base geopotential (m2/s2), in place.
// Implausible heights become NaN.
void GeopotentialToHeight(const std::vector<float>& base, std::vector<float>& geopotential);

// Returns the heights of the interfaces between layers whose middles are known. An interface is
// half-way between two middles. The lowest is the ground if `ground_m` is not empty, and otherwise
// as far below the lowest middle as the next interface is above it. The highest is as far above the
// highest middle as the next interface is below it. A ground is not used if it is missing, not
// below the lowest middle, or farther below it than 1.5 times the distance to the next middle.
// Missing middles give missing interfaces. The first present middle above missing ones is the
// lowest. A single layer needs the ground.
std::vector<float> InterfacesBetween(const std::vector<float>& middles_m,
                                     const std::vector<float>& ground_m, int levels,
                                     std::size_t columns);

// The state of the air in each layer, as the file gives it. Missing values are NaN. A file has
// either the pressure and one of the two temperatures, or the density instead.
struct LayerState {
  std::vector<float> pressure_Pa;
  std::vector<float> potential_temperature_K;
  std::vector<float> vapour_kg_per_kg;  // per kg of dry air; empty if the air is dry
  std::vector<float> temperature_K;
  // The density of the whole air. The density of dry air follows by subtracting the vapour, but not
  // the condensate, which is at most 2 % of the mass.
  std::vector<float> air_density_kg_per_m3;
};

// The largest mass of vapour per mass of dry air that is accepted. Nature's largest is 0.04.
inline constexpr float kHighestVapour_kg_per_kg = 0.1F;

// Returns whether air can have this temperature: from 100 to 400 K. Returns false for NaN.
bool IsAirTemperature(double temperature_K);

// Replaces temperatures that air cannot have by NaN.
void LeaveOutImpossibleTemperatures(std::vector<float>& temperature_K);

// Returns the temperature of every layer, or an empty array if the file has only the density. It
// is NaN where it is missing or impossible (IsAirTemperature).
std::vector<float> Temperature(const LayerState& state);

// Returns the largest mass of vapour per mass of dry air in layers that have a usable density, if
// it is above kHighestVapour_kg_per_kg. Returns nothing otherwise.
std::optional<float> ImpossibleVapour(const LayerState& state,
                                      const std::vector<float>& interface_height_m,
                                      std::size_t columns);

// Returns the density of dry air in every layer. Reuses the memory of `state`. The density of a
// layer with missing or unordered interfaces, or with an impossible temperature, is NaN.
std::vector<float> DryAirDensity(LayerState state, const std::vector<float>& interface_height_m,
                                 std::size_t columns);

// Returns the density of dry air, vapour and condensate together. `condensate` is the share of the
// whole mass that is condensate, and `vapour_kg_per_kg` may be empty.
std::vector<float> WholeAirDensity(const std::vector<float>& dry_air_density_kg_per_m3,
                                   const std::vector<float>& vapour_kg_per_kg,
                                   const std::vector<float>& condensate);

}  // namespace thunderhead::storm_files
