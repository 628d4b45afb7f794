#include "physics/particle_size.h"

#include <cmath>
#include <numbers>

namespace thunderhead::physics {

float ConstantRadius_m(Hydrometeor hydrometeor, SizeSource source, float given_m) {
  switch (source) {
    case SizeSource::kPapers:
      return PapersRadius_m(hydrometeor);
    case SizeSource::kGiven:
      return given_m;
    case SizeSource::kModel:
      break;
  }
  return DefaultOptics(hydrometeor).radius_m;
}

float EffectiveRadius_m(Hydrometeor hydrometeor, float mass_kg) {
  constexpr double kDropletRatio = 1.1157;      // 0.72^(-1/3)
  constexpr double kExponentialRatio = 1.6510;  // 3 / 6^(1/3)
  const double density = DefaultOptics(hydrometeor).density_kg_per_m3;
  const double volume_radius_m =
      std::cbrt(3.0 * static_cast<double>(mass_kg) / (4.0 * std::numbers::pi * density));
  const double ratio = hydrometeor == Hydrometeor::kCloud ? kDropletRatio : kExponentialRatio;
  return static_cast<float>(ratio * volume_radius_m);
}

}  // namespace thunderhead::physics
