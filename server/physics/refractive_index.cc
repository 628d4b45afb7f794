#include "physics/refractive_index.h"

#include <cmath>

namespace thunderhead::physics {

double WaterRefractiveIndex(double wavelength_um) {
  constexpr double kDensity = 999.70 / 1000.0;  // density of water, relative to 1000 kg/m3
  constexpr double kTemperature = 283.15 / 273.15;
  // Converts an index relative to vacuum to an index relative to air.
  constexpr double kAir = 1.00028;
  const double wavelength = wavelength_um / 0.589;
  const double w2 = wavelength * wavelength;
  constexpr double kUltraviolet = 0.2292020;
  constexpr double kInfrared = 5.432937;
  const double refraction = 0.244257733 + 9.74634476e-3 * kDensity - 3.73234996e-3 * kTemperature +
                            2.68678472e-4 * w2 * kTemperature + 1.58920570e-3 / w2 +
                            2.45934259e-3 / (w2 - kUltraviolet * kUltraviolet) +
                            0.900704920 / (w2 - kInfrared * kInfrared) -
                            1.66626219e-2 * kDensity * kDensity;
  const double r = refraction * kDensity;
  return std::sqrt((1.0 + 2.0 * r) / (1.0 - r)) / kAir;
}

}  // namespace thunderhead::physics
