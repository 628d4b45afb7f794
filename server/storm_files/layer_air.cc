#include "storm_files/layer_air.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "physics/air.h"

namespace thunderhead::storm_files {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

// Comparisons with these bounds fail for NaN. The bounds are far outside any atmosphere and catch
// fill codes like -999.
constexpr float kHighestPressure_Pa = 1e6F;
constexpr float kHighestDensity_kg_per_m3 = 100.0F;
constexpr float kLowestVapour = -0.5F;  // advection can make values slightly negative

// Returns the temperature of cell `i`, or NaN if it is missing or impossible.
double TemperatureAt(const LayerState& state, std::size_t i) {
  const double temperature_K =
      state.temperature_K.empty()
          ? physics::Temperature_K(state.potential_temperature_K[i], state.pressure_Pa[i])
          : static_cast<double>(state.temperature_K[i]);
  return IsAirTemperature(temperature_K) ? temperature_K : static_cast<double>(kMissing);
}

// Returns the density of dry air in cell `i`, or NaN.
float DensityAt(const LayerState& state, std::size_t i) {
  const float vapour = state.vapour_kg_per_kg.empty() ? 0.0F : state.vapour_kg_per_kg[i];
  if (!(vapour > kLowestVapour)) return kMissing;
  const float q_v = std::max(vapour, 0.0F);
  if (!state.air_density_kg_per_m3.empty()) {
    const float density = state.air_density_kg_per_m3[i];
    const bool usable = density > 0.0F && density < kHighestDensity_kg_per_m3;
    return usable ? density / (1.0F + q_v) : kMissing;
  }
  const float pressure_Pa = state.pressure_Pa[i];
  if (!(pressure_Pa > 0.0F && pressure_Pa < kHighestPressure_Pa)) return kMissing;
  const double temperature_K = TemperatureAt(state, i);
  if (std::isnan(temperature_K)) return kMissing;
  return static_cast<float>(physics::DryAirDensity_kg_per_m3(pressure_Pa, temperature_K, q_v));
}

}  // namespace

bool IsAirTemperature(double temperature_K) {
  constexpr double kLowest_K = 100.0;
  constexpr double kHighest_K = 400.0;
  return temperature_K >= kLowest_K && temperature_K <= kHighest_K;
}

void LeaveOutImpossibleTemperatures(std::vector<float>& temperature_K) {
  for (float& each_K : temperature_K) each_K = IsAirTemperature(each_K) ? each_K : kMissing;
}

void GeopotentialToHeight(const std::vector<float>& base, std::vector<float>& geopotential) {
  constexpr float kHighest_m = 1e6F;
  for (std::size_t i = 0; i < geopotential.size(); ++i) {
    const double sum = static_cast<double>(geopotential[i]) + base[i];
    const auto height_m = static_cast<float>(sum / physics::kGravity_m_per_s2);
    geopotential[i] = std::abs(height_m) < kHighest_m ? height_m : kMissing;
  }
}

std::vector<float> InterfacesBetween(const std::vector<float>& middles_m,
                                     const std::vector<float>& ground_m, int levels,
                                     std::size_t columns) {
  std::vector<float> interfaces((static_cast<std::size_t>(levels) + 1) * columns, kMissing);
  const auto middle = [&](int level, std::size_t column) {
    const bool exists = level >= 0 && level < levels;
    return exists ? middles_m[static_cast<std::size_t>(level) * columns + column] : kMissing;
  };
  for (int face = 0; face <= levels; ++face) {
    for (std::size_t column = 0; column < columns; ++column) {
      const float below = middle(face - 1, column);
      const float above = middle(face, column);
      float& height_m = interfaces[static_cast<std::size_t>(face) * columns + column];
      if (!std::isnan(below) && !std::isnan(above)) {
        height_m = 0.5F * (below + above);
      } else if (!std::isnan(above)) {
        // The layer of the lowest level reaches the ground, unless the levels begin far above it.
        constexpr float kFar = 1.5F;
        const float step_m = middle(face + 1, column) - above;
        height_m = above - 0.5F * step_m;
        const float ground = ground_m.empty() ? kMissing : ground_m[column];
        if (ground < above && !(above - ground > kFar * step_m)) height_m = ground;
      } else if (!std::isnan(below)) {
        const float lower_m = interfaces[static_cast<std::size_t>(face - 1) * columns + column];
        height_m = 2.0F * below - lower_m;
        if (const float next = middle(face - 2, column); !std::isnan(next)) {
          height_m = below + 0.5F * (below - next);
        }
      }
    }
  }
  return interfaces;
}

std::vector<float> Temperature(const LayerState& state) {
  const bool potential = state.temperature_K.empty() && !state.potential_temperature_K.empty();
  std::vector<float> temperature_K(potential ? state.pressure_Pa.size()
                                             : state.temperature_K.size());
  for (std::size_t i = 0; i < temperature_K.size(); ++i) {
    temperature_K[i] = static_cast<float>(TemperatureAt(state, i));
  }
  return temperature_K;
}

std::optional<float> ImpossibleVapour(const LayerState& state,
                                      const std::vector<float>& interface_height_m,
                                      std::size_t columns) {
  std::optional<float> largest;
  for (std::size_t i = 0; i < state.vapour_kg_per_kg.size(); ++i) {
    const float vapour = state.vapour_kg_per_kg[i];
    const bool rises = interface_height_m[i + columns] > interface_height_m[i];
    if (!(vapour > largest.value_or(kHighestVapour_kg_per_kg)) || !rises) continue;
    if (!std::isnan(DensityAt(state, i))) largest = vapour;
  }
  return largest;
}

std::vector<float> DryAirDensity(LayerState state, const std::vector<float>& interface_height_m,
                                 std::size_t columns) {
  std::vector<float>& density =
      state.air_density_kg_per_m3.empty() ? state.pressure_Pa : state.air_density_kg_per_m3;
  for (std::size_t i = 0; i < density.size(); ++i) {
    const bool rises = interface_height_m[i + columns] > interface_height_m[i];
    density[i] = rises ? DensityAt(state, i) : kMissing;
  }
  return std::move(density);
}

std::vector<float> WholeAirDensity(const std::vector<float>& dry_air_density_kg_per_m3,
                                   const std::vector<float>& vapour_kg_per_kg,
                                   const std::vector<float>& condensate) {
  std::vector<float> density = dry_air_density_kg_per_m3;
  for (std::size_t i = 0; i < density.size(); ++i) {
    const float vapour = vapour_kg_per_kg.empty() ? 0.0F : std::max(vapour_kg_per_kg[i], 0.0F);
    density[i] *= (1.0F + vapour) / (1.0F - condensate[i]);
  }
  return density;
}

}  // namespace thunderhead::storm_files
