#include "storm_files/reference_atmosphere.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::storm_files {
namespace {

// COSMO's own constants.
constexpr double kGravity_m_per_s2 = 9.80665;
constexpr double kGas_J_per_kg_K = 287.05;

constexpr int kConstantLapse = 1;
constexpr int kExponential = 2;

}  // namespace

double ReferenceAtmosphere::Pressure_Pa(double height_m) const {
  if (exponential) {
    const double top_K = sea_level_K - excess_K;
    const double integral_m_per_K =
        scale_height_m / top_K *
        std::log((std::exp(height_m / scale_height_m) * top_K + excess_K) / sea_level_K);
    return sea_level_Pa * std::exp(-kGravity_m_per_s2 / kGas_J_per_kg_K * integral_m_per_K);
  }
  const double depth = kGravity_m_per_s2 * height_m / (kGas_J_per_kg_K * sea_level_K);
  if (lapse_K == 0.0) return sea_level_Pa * std::exp(-depth);
  // Above the height at which the temperature would be 0 K, the pressure stays the same.
  const double root = std::sqrt(std::max(0.0, 1.0 - 2.0 * lapse_K * depth / sea_level_K));
  return sea_level_Pa * std::exp(-sea_level_K / lapse_K * (1.0 - root));
}

std::optional<ReferenceAtmosphere> ReadReferenceAtmosphere(const netcdf::NetcdfFile& file) {
  for (const std::string& name : file.Variables()) {
    const auto number = [&](const char* attribute) {
      return file.NumberAttribute(name, attribute).value_or(0.0);
    };
    const auto kind = static_cast<int>(number("irefatm"));
    if (kind != kConstantLapse && kind != kExponential) continue;
    ReferenceAtmosphere found;
    found.variable = name;
    found.sea_level_Pa = number("p0sl");
    found.sea_level_K = number("t0sl");
    found.lapse_K = number("dt0lp");
    found.exponential = kind == kExponential;
    found.excess_K = number("delta_t");
    found.scale_height_m = number("h_scal");
    const bool possible =
        found.sea_level_Pa > 0.0 && found.sea_level_K > 0.0 &&
        (found.exponential ? found.excess_K < found.sea_level_K && found.scale_height_m > 0.0
                           : found.lapse_K >= 0.0);
    if (possible) return found;
  }
  return std::nullopt;
}

}  // namespace thunderhead::storm_files
