// Settings of the Monte Carlo reference as a technique. It is path-traced progressively on the CPU.
#pragma once

#include <string_view>

#include "scene/capabilities.h"
#include "scene/stage.h"
#include "scene/techniques/medium_settings.h"

namespace thunderhead::scene {

struct Reference {
  static constexpr std::string_view kName = "reference";
  static constexpr Capabilities kCapabilities{
      .lights = true, .field_optics = true, .images = false};

  bool per_field_phase = true;
  bool false_colors = false;

  bool operator==(const Reference&) const = default;

  const MediumSettings* Medium() const { return nullptr; }
  FieldLook Look() const {
    return {.per_field_phase = per_field_phase, .false_colors = false_colors};
  }
  double SamplesPerPixel(double /*slice_share*/) const { return 1.0; }

  Stage DirtiedSince(const Reference& before) const {
    return *this == before ? Stage::kNothing : Stage::kExtinction;
  }
};

}  // namespace thunderhead::scene
