// The motion of the air in a file, as far as detail finer than the grid depends on it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "glm/vec2.hpp"

namespace thunderhead::volume {

// The source of the amplitude of turbulence: contrasts of the condensate between cells, the
// deformation of the wind, or turbulent kinetic energy in the file.
enum class TurbulenceSource { kGradient, kDeformation, kEnergy };
inline constexpr TurbulenceSource kLastTurbulenceSource = TurbulenceSource::kEnergy;

struct AirMotion {
  TurbulenceSource source = TurbulenceSource::kGradient;
  std::string variable;  // the file's variable of turbulent energy
  // Each array has grid.CellCount() values, x fastest, or none if the file lacks the data.
  std::vector<std::uint8_t> turbulence;  // TurbulentAmplitude of the kinetic energy, times 255
  std::vector<std::uint8_t> ascent;  // upward velocity in kAscentUnit_m_per_s; 0 where air sinks
  glm::dvec2 shear_m_per_s{0.0};     // wind at the height of ice minus wind at cloud water's
  // The mean wind of the lowest 6 km, which carries storms along (Bunkers et al. 2000). It is 0 if
  // the file lacks it, or if it is stronger than kMaxSteering_m_per_s.
  glm::dvec2 steering_m_per_s{0.0};
  double time_s = 0.0;  // the time of these winds, in seconds since 1970 in UTC
};

// Turbulence of this energy (m2/s2) has half of the full amplitude. It corresponds to gusts of 0.4
// m/s.
inline constexpr float kHalfAmplitudeEnergy_m2_per_s2 = 0.25F;
inline constexpr double kMaxSteering_m_per_s = 150.0;
inline constexpr float kAscentUnit_m_per_s = 0.25F;

// Returns the amplitude of detail, from 0 to 1, for this turbulent kinetic energy (at least 0).
inline float TurbulentAmplitude(float energy_m2_per_s2) {
  return energy_m2_per_s2 / (energy_m2_per_s2 + kHalfAmplitudeEnergy_m2_per_s2);
}

// Both functions return a value as AirMotion stores it, before rounding. A missing value becomes 0.
inline float TurbulenceByte(float energy_m2_per_s2) {
  return energy_m2_per_s2 > 0.0F ? 255.0F * TurbulentAmplitude(std::min(energy_m2_per_s2, 1e6F))
                                 : 0.0F;
}
inline float AscentByte(float upward_m_per_s) {
  return upward_m_per_s > 0.0F ? upward_m_per_s / kAscentUnit_m_per_s : 0.0F;
}

}  // namespace thunderhead::volume
