// The arithmetic of levels and air for GRIB files: levels under the ground, hydrostatic heights,
// vapour, and the phase of cloud water. This code does not depend on files.
//
// All arrays have the column running fastest, then levels upwards. Missing values are NaN.
#pragma once

#include <cstddef>
#include <vector>

namespace thunderhead::storm_files {

inline constexpr double kStandardGravity_m_per_s2 = 9.80665;  // of geopotential heights

// Moves the interfaces of levels below the ground to the ground, so that these levels are empty. A
// level is below the ground if its pressure is higher than that of the ground. If the file has no
// surface pressure, heights are compared instead. An empty `surface_pressure_Pa` or `ground_m`
// means that the file does not have it. If `ground_m` is empty, levels below the ground become
// missing (NaN) instead.
void CutAtGround(const std::vector<double>& level_pressure_Pa, const std::vector<float>& height_m,
                 const std::vector<float>& surface_pressure_Pa, const std::vector<float>& ground_m,
                 std::vector<float>& interface_height_m);

// Fills in missing heights of isobaric levels by the hypsometric equation. A height is computed
// from the next lower level, or from the next higher one if no lower level has a height.
// `has_height` says for each level whether the file has its height. If it has none, heights begin
// with `ground_m` at `surface_pressure_Pa`.
void FillHeights(const std::vector<double>& level_pressure_Pa,
                 const std::vector<float>& virtual_temperature_K,
                 const std::vector<bool>& has_height, const std::vector<float>& surface_pressure_Pa,
                 const std::vector<float>& ground_m, std::vector<float>& height_m);

// Returns the pressures of the interfaces of hybrid levels, upwards. `coefficients` are all a (Pa)
// and then all b of half levels, downwards. The lowest interface is the ground. `levels` is the
// number of levels above the ground.
std::vector<float> HybridPressures(const std::vector<float>& coefficients, std::size_t levels,
                                   const std::vector<float>& surface_pressure_Pa);

// Returns the hydrostatic heights of interfaces whose pressures are `interface_pressure_Pa`.
std::vector<float> HydrostaticInterfaces(const std::vector<float>& interface_pressure_Pa,
                                         const std::vector<float>& virtual_temperature_K,
                                         const std::vector<float>& ground_m);

// Returns the temperature (K) at which dry air has the same density. `vapour_kg_per_kg` is per kg
// of dry air, and empty for dry air.
std::vector<float> VirtualTemperature_K(const std::vector<float>& temperature_K,
                                        const std::vector<float>& vapour_kg_per_kg);

// Converts specific humidity (kg per kg of moist air) into vapour per kg of dry air, in place.
void SpecificHumidityToVapour(std::vector<float>& humidity);

// Converts relative humidity over water (percent) into vapour per kg of dry air, in place. Source:
// Bolton 1980, equation 10.
void RelativeHumidityToVapour(const std::vector<float>& pressure_Pa,
                              const std::vector<float>& temperature_K,
                              std::vector<float>& humidity_percent);

// Returns the share of ice in cloud water at a temperature: 1 below -40 C, 0 above 0 C, and linear
// between.
float IceShare(float temperature_K);

// Converts vertical wind from Pa/s to m/s, in place.
void OmegaToAscent(const std::vector<float>& pressure_Pa,
                   const std::vector<float>& virtual_temperature_K, std::vector<float>& omega);

}  // namespace thunderhead::storm_files
