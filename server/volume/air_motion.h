// The motion of the air that a file has, as far as detail finer than its grid depends on it.
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
  std::string variable;  // of the energy
  // grid.CellCount() values each, x fastest; empty if the file does not tell.
  std::vector<std::uint8_t> turbulence;  // TurbulentAmplitude of the kinetic energy, of 255
  std::vector<std::uint8_t> ascent;  // upward velocity in kAscentUnit_m_per_s; 0 where air sinks
  glm::dvec2 shear_m_per_s{0.0};     // wind at the height of ice less that at cloud water's
  // The mean wind of the lowest 6 km, by which storms are carried along (Bunkers et al. 2000); 0 if
  // the file does not tell, or if that is stronger than kMaxSteering_m_per_s.
  glm::dvec2 steering_m_per_s{0.0};
  double time_s = 0.0;  // at which it blows, since 1970 in UTC
};

// Turbulence of this energy (m2/s2) has half of the full amplitude: gusts of 0.4 m/s.
inline constexpr float kHalfAmplitudeEnergy_m2_per_s2 = 0.25F;
inline constexpr double kMaxSteering_m_per_s = 150.0;
inline constexpr float kAscentUnit_m_per_s = 0.25F;

// Amplitude of detail, 0 to 1, where turbulence has this kinetic energy (at least 0).
inline float TurbulentAmplitude(float energy_m2_per_s2) {
  return energy_m2_per_s2 / (energy_m2_per_s2 + kHalfAmplitudeEnergy_m2_per_s2);
}

// As AirMotion stores them, before rounding; of missing values 0.
inline float TurbulenceByte(float energy_m2_per_s2) {
  return energy_m2_per_s2 > 0.0F ? 255.0F * TurbulentAmplitude(std::min(energy_m2_per_s2, 1e6F))
                                 : 0.0F;
}
inline float AscentByte(float upward_m_per_s) {
  return upward_m_per_s > 0.0F ? upward_m_per_s / kAscentUnit_m_per_s : 0.0F;
}

}  // namespace thunderhead::volume
