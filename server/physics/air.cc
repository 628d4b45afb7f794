#include "physics/air.h"

#include <cmath>

namespace thunderhead::physics {

double Temperature_K(double potential_temperature_K, double pressure_Pa) {
  constexpr double kKappa = kGasConstantDryAir_J_per_kg_K / kHeatCapacityDryAir_J_per_kg_K;
  return potential_temperature_K * std::pow(pressure_Pa / kReferencePressure_Pa, kKappa);
}

double DryAirDensity_kg_per_m3(double pressure_Pa, double temperature_K, double vapour_kg_per_kg) {
  constexpr double kVapourPerDryGasConstant = 1.608;
  return pressure_Pa / (kGasConstantDryAir_J_per_kg_K * temperature_K *
                        (1.0 + kVapourPerDryGasConstant * vapour_kg_per_kg));
}

}  // namespace thunderhead::physics
