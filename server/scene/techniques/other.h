// Settings of a technique that was added as an extension (docs/extending.md). The settings are
// named numbers. The technique's name and capabilities are in renderers/technique_registry.h.
#pragma once

#include <map>
#include <string>

#include "scene/capabilities.h"
#include "scene/stage.h"
#include "scene/techniques/medium_settings.h"

namespace thunderhead::scene {

struct OtherTechnique {
  // The capabilities that apply until the registry entry gives others. `lights` is true so that a
  // change of the scene's lights reruns the technique.
  static constexpr Capabilities kCapabilities{.lights = true};

  std::string name;
  std::map<std::string, double> numbers;

  bool operator==(const OtherTechnique&) const = default;

  const MediumSettings* Medium() const { return nullptr; }
  FieldLook Look() const { return {}; }
  double SamplesPerPixel(double /*slice_share*/) const { return 64.0; }

  Stage DirtiedSince(const OtherTechnique& before) const {
    return *this == before ? Stage::kNothing : Stage::kExtinction;
  }
};

}  // namespace thunderhead::scene
