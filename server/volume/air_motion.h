// The motion of the air at one time of a storm. It controls the strength and shape of the drawn
// detail that is finer than the model's grid.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "glm/vec2.hpp"

namespace thunderhead::volume {

// The source from which the amplitude of turbulence is derived. kGradient uses differences of
// condensate between cells, kDeformation the deformation of the wind, and kEnergy the file's
// turbulent kinetic energy.
enum class TurbulenceSource { kGradient, kDeformation, kEnergy };
inline constexpr TurbulenceSource kLastTurbulenceSource = TurbulenceSource::kEnergy;

struct AirMotion {
  TurbulenceSource source = TurbulenceSource::kGradient;
  std::string variable;  // name of the file's variable of turbulent kinetic energy
  // Each array has grid.CellCount() values, x fastest, or is empty if the file lacks the data.
  std::vector<std::uint8_t> turbulence;  // TurbulentAmplitude of the kinetic energy, times 255
  std::vector<std::uint8_t> ascent;  // upward velocity in units of kAscentUnit_m_per_s; 0 where air
                                     // sinks
  glm::dvec2 shear_m_per_s{0.0};     // wind at the mean height of ice minus wind at the mean height
                                     // of cloud water
  // The mean wind of the lowest 6 km, which carries storms along (Bunkers et al. 2000). It is 0 if
  // the file has no wind, or if the mean is stronger than kMaxSteering_m_per_s.
  glm::dvec2 steering_m_per_s{0.0};
  double time_s = 0.0;  // the time of these winds, in seconds since 1970 in UTC
};

// The turbulent kinetic energy at which TurbulentAmplitude returns 0.5. It corresponds to gusts of
// 0.4 m/s.
inline constexpr float kHalfAmplitudeEnergy_m2_per_s2 = 0.25F;
inline constexpr double kMaxSteering_m_per_s = 150.0;
inline constexpr float kAscentUnit_m_per_s = 0.25F;

// Returns the amplitude of detail, from 0 to 1, for a turbulent kinetic energy, which must not be
// negative.
inline float TurbulentAmplitude(float energy_m2_per_s2) {
  return energy_m2_per_s2 / (energy_m2_per_s2 + kHalfAmplitudeEnergy_m2_per_s2);
}

// These two functions return the values of AirMotion::turbulence and AirMotion::ascent before
// rounding to a byte. A missing value (NaN) becomes 0.
inline float TurbulenceByte(float energy_m2_per_s2) {
  return energy_m2_per_s2 > 0.0F ? 255.0F * TurbulentAmplitude(std::min(energy_m2_per_s2, 1e6F))
                                 : 0.0F;
}
inline float AscentByte(float upward_m_per_s) {
  return upward_m_per_s > 0.0F ? upward_m_per_s / kAscentUnit_m_per_s : 0.0F;
}

}  // namespace thunderhead::volume
