// Settings of the metaball technique (Man, Generating and Real-Time Rendering of Clouds).
#pragma once

#include <array>
#include <cmath>
#include <string_view>

#include "scene/capabilities.h"
#include "scene/stage.h"
#include "scene/techniques/medium_settings.h"

namespace thunderhead::scene {

struct Metaballs {
  static constexpr std::string_view kName = "metaball";
  static constexpr std::array kTransports = {Transport::kConsistent, Transport::kLowAlbedo,
                                             Transport::kPaper};
  static constexpr Capabilities kCapabilities{.lights = true,
                                              .detail = DetailUse::kRoughness,
                                              .field_optics = true,
                                              .transports = kTransports};

  MediumSettings medium{.transport = kTransports.front()};
  // Upper limit of the number of balls; the default is that of the paper's first scene.
  int count = 1200;
  bool isotropic = false;
  double albedo = 0.9;         // a of Man's eq. 26; only for Transport::kPaper
  double optical_depth = 8.0;  // tau of Man's eq. 26; only for Transport::kPaper

  bool operator==(const Metaballs&) const = default;

  const MediumSettings* Medium() const { return &medium; }
  FieldLook Look() const { return medium.look; }

  // Returns the number of balls that cover a pixel. The balls fill a volume, so this number grows
  // with the cube root of the number of balls.
  double SamplesPerPixel(double /*slice_share*/) const { return 3.0 * std::cbrt(count); }

  Stage DirtiedSince(const Metaballs& before) const {
    if (medium.look != before.medium.look) return Stage::kExtinction;
    return *this == before ? Stage::kNothing : Stage::kLight;
  }
};

}  // namespace thunderhead::scene
