#include "storm_files/layer_air.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "physics/air.h"

namespace thunderhead::storm_files {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

float DensityOf(float pressure_Pa, float potential_temperature_K, float vapour_kg_per_kg) {
  // Comparisons fail for NaN. The bounds are far outside any atmosphere and catch fill codes like
  // -999.
  constexpr float kHighestPressure_Pa = 1e6F;
  constexpr float kHighestTheta_K = 1e5F;
  constexpr float kLowestVapour = -0.5F;  // advection can make values slightly negative
  const bool usable = pressure_Pa > 0.0F && pressure_Pa < kHighestPressure_Pa &&
                      potential_temperature_K > 0.0F && potential_temperature_K < kHighestTheta_K &&
                      vapour_kg_per_kg > kLowestVapour;
  if (!usable) return kMissing;
  const double temperature_K = physics::Temperature_K(potential_temperature_K, pressure_Pa);
  return static_cast<float>(physics::DryAirDensity_kg_per_m3(pressure_Pa, temperature_K,
                                                             std::max(vapour_kg_per_kg, 0.0F)));
}

}  // namespace

void GeopotentialToHeight(const std::vector<float>& base, std::vector<float>& geopotential) {
  constexpr float kHighest_m = 1e6F;
  for (std::size_t i = 0; i < geopotential.size(); ++i) {
    const double sum = static_cast<double>(geopotential[i]) + base[i];
    const auto height_m = static_cast<float>(sum / physics::kGravity_m_per_s2);
    geopotential[i] = std::abs(height_m) < kHighest_m ? height_m : kMissing;
  }
}

std::vector<float> Temperature(const LayerState& state) {
  std::vector<float> temperature_K(state.pressure_Pa.size());
  for (std::size_t i = 0; i < temperature_K.size(); ++i) {
    temperature_K[i] = static_cast<float>(
        physics::Temperature_K(state.potential_temperature_K[i], state.pressure_Pa[i]));
  }
  return temperature_K;
}

std::vector<float> DryAirDensity(LayerState state, const std::vector<float>& interface_height_m,
                                 std::size_t columns) {
  std::vector<float> density = std::move(state.pressure_Pa);
  for (std::size_t i = 0; i < density.size(); ++i) {
    const bool rises = interface_height_m[i + columns] > interface_height_m[i];
    const float vapour = state.vapour_kg_per_kg.empty() ? 0.0F : state.vapour_kg_per_kg[i];
    density[i] = rises ? DensityOf(density[i], state.potential_temperature_K[i], vapour) : kMissing;
  }
  return density;
}

}  // namespace thunderhead::storm_files
