// Settings of the cumulus technique: a surface of ellipsoids with phenomenological shading (Neyret
// 2000).
#pragma once

#include <cstdint>
#include <string_view>

#include "scene/capabilities.h"
#include "scene/stage.h"
#include "scene/techniques/medium_settings.h"

namespace thunderhead::scene {

// The source of the surface: the storm's cloud water and ice, a hierarchy of bubbles, the
// ellipsoids of one of the generator's presets, or a single ellipsoid. A source other than the
// storm fills the storm's place.
enum class CumulusSource {
  kStorm,
  kCauliflower,
  kFairWeatherCumulus,
  kCongestus,
  kCumulusField,
  kEllipsoid
};

// The part of the light that is shown. kBalls shades bare ellipsoids by Lambert's law, as the
// baseline for the cost of the shading.
enum class CumulusComponent { kAll, kDirect, kInterReflection, kAmbient, kCorona, kBalls };

struct Cumulus {
  static constexpr std::string_view kName = "cumulus";
  static constexpr Capabilities kCapabilities{};

  CumulusSource source = CumulusSource::kStorm;
  std::uint32_t seed = 1;
  int scales = 3;                        // levels of ellipsoids
  float least_extinction_per_m = 2e-3F;  // extinction of a storm that counts as inside the surface
  // Thickness relative to the radius of the finest ellipsoids.
  float corona = 0.45F;
  float trap = 0.45F;          // share of the sky that the deepest valley hides
  float transmission = 0.05F;  // share of sunlight that passes through
  float roughness = 0.6F;
  CumulusComponent component = CumulusComponent::kAll;

  bool operator==(const Cumulus&) const = default;

  const MediumSettings* Medium() const { return nullptr; }
  FieldLook Look() const { return {}; }

  // Returns the number of fragments over a pixel, which is about the same for any surface of
  // several scales.
  double SamplesPerPixel(double /*slice_share*/) const { return 20.0; }

  Stage DirtiedSince(const Cumulus& before) const {
    if (source != before.source || seed != before.seed || scales != before.scales ||
        least_extinction_per_m != before.least_extinction_per_m) {
      return Stage::kExtinction;
    }
    // The surface without its corona shades the ground behind it, so the corona changes the
    // ground's light.
    if (corona != before.corona) return Stage::kLight;
    return *this == before ? Stage::kNothing : Stage::kView;
  }
};

}  // namespace thunderhead::scene
