// The thermodynamics of air needed to read a storm file: temperature from potential temperature,
// and density of dry air. The functions are pure and use SI units.
#pragma once

namespace thunderhead::physics {

inline constexpr double kGasConstantDryAir_J_per_kg_K = 287.0;
inline constexpr double kHeatCapacityDryAir_J_per_kg_K = 1004.5;  // 7/2 R_d, as in WRF
inline constexpr double kReferencePressure_Pa = 1e5;
inline constexpr double kGravity_m_per_s2 = 9.81;  // as in WRF

// Returns the temperature (K) from potential temperature (K) and pressure (Pa, above zero).
double Temperature_K(double potential_temperature_K, double pressure_Pa);

// Returns the density of the dry part of moist air (kg/m3). The arguments are total pressure (Pa),
// temperature (K) and water vapour mixing ratio (kg per kg of dry air). The formula is p / (R_d T
// (1 + 1.608 q_v)).
double DryAirDensity_kg_per_m3(double pressure_Pa, double temperature_K, double vapour_kg_per_kg);

}  // namespace thunderhead::physics
