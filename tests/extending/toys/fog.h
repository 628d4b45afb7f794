// Settings of a fog, a technique that only tests/extending knows.
#pragma once

#include <string_view>

#include "scene/capabilities.h"
#include "scene/stage.h"
#include "scene/techniques/medium_settings.h"

namespace thunderhead::scene {

struct Fog {
  static constexpr std::string_view kName = "fog";
  static constexpr Capabilities kCapabilities{};

  float depth_m = 50.0F;
  bool false_colors = false;

  bool operator==(const Fog&) const = default;

  const MediumSettings* Medium() const { return nullptr; }
  FieldLook Look() const { return {.false_colors = false_colors}; }
  double SamplesPerPixel(double /*slice_share*/) const { return 1.0; }

  Stage DirtiedSince(const Fog& before) const {
    return *this == before ? Stage::kNothing : Stage::kView;
  }
};

}  // namespace thunderhead::scene
