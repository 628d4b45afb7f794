#include "storm_files/grib_air.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thunderhead::storm_files {
namespace {

constexpr double kGasConstant_J_per_kg_K = 287.0597;  // of dry air, as in IFS
constexpr double kVapourRatio = 0.621981;             // gas constants of dry air over vapour
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

// Returns the thickness of the air between two pressures.
double Thickness_m(double low_pressure_Pa, double high_pressure_Pa, double virtual_temperature_K) {
  return kGasConstant_J_per_kg_K * virtual_temperature_K *
         std::log(low_pressure_Pa / high_pressure_Pa) / kStandardGravity_m_per_s2;
}

}  // namespace

void CutAtGround(const std::vector<double>& level_pressure_Pa, const std::vector<float>& height_m,
                 const std::vector<float>& surface_pressure_Pa, const std::vector<float>& ground_m,
                 std::vector<float>& interface_height_m) {
  const std::size_t levels = level_pressure_Pa.size();
  const std::size_t columns = height_m.size() / levels;
  for (std::size_t column = 0; column < columns; ++column) {
    const float ground = ground_m.empty() ? kNoValue : ground_m[column];
    for (std::size_t i = 0; i < levels; ++i) {
      const std::size_t at = i * columns + column;
      const bool is_under_pressure =
          !surface_pressure_Pa.empty() &&
          level_pressure_Pa[i] > static_cast<double>(surface_pressure_Pa[column]);
      const bool is_under_height =
          surface_pressure_Pa.empty() && !ground_m.empty() && height_m[at] < ground;
      if (is_under_pressure || is_under_height) {
        interface_height_m[at] = ground;
        if (!std::isnan(ground)) interface_height_m[at + columns] = ground;
        continue;
      }
      // The interface above this level is half-way to the next level. If the ground lies higher
      // than that, the level ends at the ground.
      interface_height_m[at + columns] = std::max(interface_height_m[at + columns], ground);
    }
  }
}

void FillHeights(const std::vector<double>& level_pressure_Pa,
                 const std::vector<float>& virtual_temperature_K,
                 const std::vector<bool>& has_height, const std::vector<float>& surface_pressure_Pa,
                 const std::vector<float>& ground_m, std::vector<float>& height_m) {
  const std::size_t levels = level_pressure_Pa.size();
  const std::size_t columns = virtual_temperature_K.size() / levels;
  // Computes the height of level `to` from level `from`, with the mean temperature between them.
  const auto fill = [&](std::size_t from, std::size_t to) {
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t known = from * columns + column;
      const std::size_t wanted = to * columns + column;
      const double mean_K = 0.5 * (virtual_temperature_K[known] + virtual_temperature_K[wanted]);
      height_m[wanted] =
          height_m[known] +
          static_cast<float>(Thickness_m(level_pressure_Pa[from], level_pressure_Pa[to], mean_K));
    }
  };
  std::vector<bool> is_known = has_height;
  if (std::ranges::find(is_known, true) == is_known.end()) {
    for (std::size_t column = 0; column < columns; ++column) {
      height_m[column] = ground_m[column] + static_cast<float>(Thickness_m(
                                                surface_pressure_Pa[column], level_pressure_Pa[0],
                                                virtual_temperature_K[column]));
    }
    is_known[0] = true;
  }
  for (std::size_t i = 1; i < levels; ++i) {
    if (is_known[i] || !is_known[i - 1]) continue;
    fill(i - 1, i);
    is_known[i] = true;
  }
  for (std::size_t i = levels - 1; i > 0; --i) {
    if (is_known[i - 1] || !is_known[i]) continue;
    fill(i, i - 1);
    is_known[i - 1] = true;
  }
}

std::vector<float> HybridPressures(const std::vector<float>& coefficients, std::size_t levels,
                                   const std::vector<float>& surface_pressure_Pa) {
  const std::size_t half_levels = coefficients.size() / 2;
  const std::size_t columns = surface_pressure_Pa.size();
  std::vector<float> pressures((levels + 1) * columns);
  for (std::size_t i = 0; i <= levels; ++i) {
    const std::size_t half_level = half_levels - 1 - i;
    const double a_Pa = coefficients[half_level];
    const double b = coefficients[half_levels + half_level];
    for (std::size_t column = 0; column < columns; ++column) {
      pressures[i * columns + column] = static_cast<float>(a_Pa + b * surface_pressure_Pa[column]);
    }
  }
  return pressures;
}

std::vector<float> HydrostaticInterfaces(const std::vector<float>& interface_pressure_Pa,
                                         const std::vector<float>& virtual_temperature_K,
                                         const std::vector<float>& ground_m) {
  const std::size_t columns = ground_m.size();
  const std::size_t levels = virtual_temperature_K.size() / columns;
  // The pressure at the top of the model can be 0. The highest level then ends where the pressure
  // is half of that at its bottom.
  constexpr float kLeastShare = 0.5F;
  std::vector<float> heights(interface_pressure_Pa.size());
  for (std::size_t column = 0; column < columns; ++column) {
    double height_m = ground_m[column];
    heights[column] = ground_m[column];
    for (std::size_t i = 0; i < levels; ++i) {
      const std::size_t at = i * columns + column;
      const float low_Pa = interface_pressure_Pa[at];
      float high_Pa = interface_pressure_Pa[at + columns];
      if (high_Pa <= 0.0F) high_Pa = kLeastShare * low_Pa;
      height_m += Thickness_m(low_Pa, high_Pa, virtual_temperature_K[at]);
      heights[at + columns] = static_cast<float>(height_m);
    }
  }
  return heights;
}

std::vector<float> VirtualTemperature_K(const std::vector<float>& temperature_K,
                                        const std::vector<float>& vapour_kg_per_kg) {
  if (vapour_kg_per_kg.empty()) return temperature_K;
  std::vector<float> virtual_K(temperature_K.size());
  for (std::size_t i = 0; i < virtual_K.size(); ++i) {
    const double vapour = std::max(vapour_kg_per_kg[i], 0.0F);
    virtual_K[i] =
        static_cast<float>(temperature_K[i] * (1.0 + vapour / kVapourRatio) / (1.0 + vapour));
  }
  return virtual_K;
}

void SpecificHumidityToVapour(std::vector<float>& humidity) {
  for (float& value : humidity) {
    // Packing can make values slightly negative. A value of 1 or more is impossible, and stays as
    // it is, so that it is refused as the vapour of usable air (ImpossibleVapour).
    if (value < 0.0F) value = 0.0F;
    if (value < 1.0F) value = value / (1.0F - value);
  }
}

void RelativeHumidityToVapour(const std::vector<float>& pressure_Pa,
                              const std::vector<float>& temperature_K,
                              std::vector<float>& humidity_percent) {
  for (std::size_t i = 0; i < humidity_percent.size(); ++i) {
    const double celsius = temperature_K[i] - 273.15;
    const double saturation_Pa = 611.2 * std::exp(17.67 * celsius / (celsius + 243.5));
    const double share = std::clamp(humidity_percent[i] / 100.0, 0.0, 2.0);
    // Near the model's top, saturation can exceed the pressure.
    const double vapour_Pa = std::min(share * saturation_Pa, 0.1 * pressure_Pa[i]);
    humidity_percent[i] =
        static_cast<float>(kVapourRatio * vapour_Pa / (pressure_Pa[i] - vapour_Pa));
  }
}

float IceShare(float temperature_K) {
  constexpr float kAllLiquid_K = 273.15F;
  constexpr float kAllIce_K = 233.15F;
  return std::clamp((kAllLiquid_K - temperature_K) / (kAllLiquid_K - kAllIce_K), 0.0F, 1.0F);
}

void OmegaToAscent(const std::vector<float>& pressure_Pa,
                   const std::vector<float>& virtual_temperature_K, std::vector<float>& omega) {
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double density =
        pressure_Pa[i] / (kGasConstant_J_per_kg_K * static_cast<double>(virtual_temperature_K[i]));
    omega[i] = static_cast<float>(-omega[i] / (density * kStandardGravity_m_per_s2));
  }
}

}  // namespace thunderhead::storm_files
