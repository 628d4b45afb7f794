#include "storm_files/mixed_water.h"

#include <algorithm>
#include <cmath>

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;

// Temperatures between which a share changes linearly from 0 to 1.
struct Ramp {
  float low_K;
  float high_K;

  float operator()(float temperature_K) const {
    return std::clamp((temperature_K - low_K) / (high_K - low_K), 0.0F, 1.0F);
  }
};

constexpr Ramp kLiquidCloud = {253.16F, 273.16F};
constexpr Ramp kRain = {268.16F, 283.16F};
constexpr Ramp kGraupelInIce = {223.16F, 283.16F};

}  // namespace

std::vector<Hydrometeor> HydrometeorsIn(MixedWater mixed) {
  switch (mixed) {
    case MixedWater::kNone:
      break;
    case MixedWater::kCloud:
      return {Hydrometeor::kCloud, Hydrometeor::kIce};
    case MixedWater::kPrecipitation:
      return {Hydrometeor::kRain, Hydrometeor::kSnow, Hydrometeor::kGraupel};
  }
  return {};
}

float ShareOf(MixedWater mixed, Hydrometeor hydrometeor, float temperature_K) {
  if (std::isnan(temperature_K)) return temperature_K;
  if (mixed == MixedWater::kNone) return 1.0F;
  if (mixed == MixedWater::kCloud) {
    const float liquid = kLiquidCloud(temperature_K);
    return hydrometeor == Hydrometeor::kCloud ? liquid : 1.0F - liquid;
  }
  const float rain = kRain(temperature_K);
  if (hydrometeor == Hydrometeor::kRain) return rain;
  const float graupel = kGraupelInIce(temperature_K);
  return (1.0F - rain) * (hydrometeor == Hydrometeor::kGraupel ? graupel : 1.0F - graupel);
}

}  // namespace thunderhead::storm_files
