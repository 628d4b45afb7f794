// Settings of the cumulus technique: a surface of ellipsoids with phenomenological shading (Neyret
// 2000).
#pragma once

#include <cstdint>
#include <string_view>

#include "scene/capabilities.h"
#include "scene/stage.h"
#include "scene/techniques/medium_settings.h"

namespace thunderhead::scene {

// The source of the surface: the storm's cloud water and ice, a generated hierarchy of bubbles
// (kCauliflower), the ellipsoids of another preset of the generator, or a single ellipsoid. A
// generated surface is scaled and placed to fill the storm's box.
enum class CumulusSource {
  kStorm,
  kCauliflower,
  kFairWeatherCumulus,
  kCongestus,
  kCumulusField,
  kEllipsoid
};

// The part of the light that is shown. kBalls shades bare ellipsoids by Lambert's law. Its cost is
// the baseline for the cost of the full shading.
enum class CumulusComponent { kAll, kDirect, kInterReflection, kAmbient, kCorona, kBalls };

struct Cumulus {
  static constexpr std::string_view kName = "cumulus";
  static constexpr Capabilities kCapabilities{};

  CumulusSource source = CumulusSource::kStorm;
  std::uint32_t seed = 1;
  int scales = 3;  // number of size levels of the ellipsoids
  // Extinction above which a point of the storm is inside the surface.
  float least_extinction_per_m = 2e-3F;
  // Thickness of the translucent rim, relative to the radius of the finest ellipsoids.
  float corona = 0.45F;
  float trap = 0.45F;          // share of the sky that is hidden from the deepest valley
  float transmission = 0.05F;  // share of sunlight that passes through the cloud
  float roughness = 0.6F;
  CumulusComponent component = CumulusComponent::kAll;

  bool operator==(const Cumulus&) const = default;

  const MediumSettings* Medium() const { return nullptr; }
  FieldLook Look() const { return {}; }

  // Returns the number of surface fragments that cover a pixel. It is about the same for any
  // surface with several size levels.
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
