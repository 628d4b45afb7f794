// Settings of half-angle slicing (Riley et al. 2003). Light and view are accumulated together
// through slices perpendicular to the bisector of the directions to sun and eye.
#pragma once

#include <array>
#include <string_view>

#include "scene/capabilities.h"
#include "scene/stage.h"
#include "scene/techniques/medium_settings.h"

namespace thunderhead::scene {

struct HalfAngle {
  static constexpr std::string_view kName = "half_angle";
  static constexpr std::array kTransports = {Transport::kConsistent, Transport::kLowAlbedo,
                                             Transport::kPaper, Transport::kPaperLowAlbedo};
  static constexpr Capabilities kCapabilities{.detail = DetailUse::kMedium,
                                              .field_optics = true,
                                              .slices = true,
                                              .transports = kTransports};

  // The renderer draws kDiffusion as kConsistent.
  MediumSettings medium{.transport = kTransports.front()};
  int slices = 128;

  bool operator==(const HalfAngle&) const = default;

  const MediumSettings* Medium() const { return &medium; }
  FieldLook Look() const { return medium.look; }
  double SamplesPerPixel(double slice_share) const { return slices * slice_share; }

  Stage DirtiedSince(const HalfAngle& before) const {
    if (medium.look != before.medium.look) return Stage::kExtinction;
    return *this == before ? Stage::kNothing : Stage::kLight;
  }
};

}  // namespace thunderhead::scene
