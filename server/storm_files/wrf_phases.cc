#include "storm_files/wrf_phases.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace thunderhead::storm_files {
namespace {

constexpr float kFreezing_K = 273.15F;
constexpr float kNoLiquidBelow_K = 233.15F;  // water freezes without nuclei at -40 C

constexpr int kKessler = 1;
constexpr int kWsm3 = 3;

}  // namespace

PhaseSplit PhaseSplitOf(int microphysics) {
  switch (microphysics) {
    case kKessler:
      return PhaseSplit::kLinear;
    case kWsm3:
      return PhaseSplit::kSharp;
    default:
      return PhaseSplit::kNone;
  }
}

physics::Hydrometeor FrozenPhaseOf(physics::Hydrometeor liquid) {
  return liquid == physics::Hydrometeor::kRain ? physics::Hydrometeor::kSnow
                                               : physics::Hydrometeor::kIce;
}

float IceShare(PhaseSplit split, float temperature_K) {
  if (std::isnan(temperature_K)) return temperature_K;
  switch (split) {
    case PhaseSplit::kNone:
      return 0.0F;
    case PhaseSplit::kSharp:
      return temperature_K < kFreezing_K ? 1.0F : 0.0F;
    case PhaseSplit::kLinear:
      break;
  }
  const float share = (kFreezing_K - temperature_K) / (kFreezing_K - kNoLiquidBelow_K);
  return std::clamp(share, 0.0F, 1.0F);
}

std::string Explained(PhaseSplit split, const std::string& variables) {
  if (split == PhaseSplit::kSharp) {
    return absl::StrCat("Water in ", variables,
                        " is ice below 0 C and liquid above, as in the scheme WSM3.");
  }
  return absl::StrCat("Water in ", variables,
                      ", where Kessler's scheme does not tell ice from liquid, is ice below -40 C, "
                      "liquid above 0 C, and a mixture that changes linearly between.");
}

}  // namespace thunderhead::storm_files
