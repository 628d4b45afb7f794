#include "clouds/cauliflower.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "clouds/presets.h"
#include "clouds/repeatable_math.h"
#include "physics/counter_random.h"

namespace thunderhead::clouds {
namespace {

absl::Status CheckScales(int scales) {
  if (scales >= 1 && scales <= kMaxScales) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("the number of scales of a cumulus is ", scales,
                                                 "; it must be from 1 to ", kMaxScales));
}

// Adds finer scales of bubbles to the existing bubbles.
void AddScales(const CauliflowerOptions& options, int scales, CumulusSurface* surface) {
  std::size_t first = 0;
  for (int scale = 0; scale < scales; ++scale) {
    const std::size_t end = surface->bubbles.size();
    Sprouting sprouting;
    sprouting.seed = options.seed;
    sprouting.lowest_sine = -1.0;  // no lower limit; the base cuts off the bubbles below it
    Sprout(sprouting, first, surface);
    first = end;
  }
  double sum_m = 0.0;
  for (std::size_t i = first; i < surface->bubbles.size(); ++i) {
    sum_m += RadiusOf(surface->bubbles[i]);
  }
  surface->finest_m =
      sum_m / static_cast<double>(std::max<std::size_t>(1, surface->bubbles.size() - first));
}

}  // namespace

absl::StatusOr<CumulusSurface> Cauliflower(const CauliflowerOptions& options) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckScales(options.scales));
  CumulusSurface surface;
  surface.base_m = 0.0;
  physics::CounterRandom random(options.seed, 4);
  const auto between = [&random](double low, double high) {
    return low + (high - low) * random.Next();
  };
  // The shape is a body with towers leaning on it: wide ones at its rim, high ones in the middle.
  surface.bubbles.push_back(
      BubbleOf({{0.0, 0.0, 120.0}, {950.0, 800.0, 420.0}, {0.0, 0.0, between(0.0, 180.0)}}));
  constexpr int kTowers = 9;
  for (int i = 0; i < kTowers; ++i) {
    const double rise = static_cast<double>(i) / (kTowers - 1);
    const double azimuth_deg = 137.5 * i + between(-25.0, 25.0);
    const double away_m = 760.0 * (1.0 - 0.85 * rise) * between(0.8, 1.1);
    const double radius_m = (330.0 + 130.0 * rise) * between(0.85, 1.2);
    surface.bubbles.push_back(BubbleOf(
        {{away_m * CosineOfDegrees(azimuth_deg), 0.85 * away_m * SineOfDegrees(azimuth_deg),
          80.0 + 620.0 * rise * between(0.8, 1.2)},
         {radius_m, radius_m * between(0.8, 1.1), radius_m * between(0.85, 1.25)},
         {between(-15.0, 15.0), between(-15.0, 15.0), azimuth_deg}}));
  }
  LayOnLarger(&surface);
  AddScales(options, options.scales - 1, &surface);
  return surface;
}

absl::StatusOr<CumulusSurface> SurfaceOfPreset(std::string_view preset,
                                               const CauliflowerOptions& options) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckScales(options.scales));
  THUNDERHEAD_ASSIGN_OR_RETURN(const CloudShape shape, PresetNamed(preset, options.seed));
  CumulusSurface surface;
  surface.base_m = shape.base_m;
  for (const Ellipsoid& ellipsoid : shape.ellipsoids)
    surface.bubbles.push_back(BubbleOf(ellipsoid));
  LayOnLarger(&surface);
  AddScales(options, options.scales - 1, &surface);
  return surface;
}

absl::StatusOr<CumulusSurface> LoneEllipsoid(const CauliflowerOptions& options) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckScales(options.scales));
  CumulusSurface surface;
  surface.bubbles.push_back(BubbleOf({{0.0, 0.0, 500.0}, {700.0, 600.0, 500.0}, {}}));
  surface.bubbles.front().outward = glm::dvec3(0.0);
  AddScales(options, options.scales - 1, &surface);
  return surface;
}

}  // namespace thunderhead::clouds
