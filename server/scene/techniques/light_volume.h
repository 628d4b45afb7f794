// Settings of the light volume. Light is propagated once into a volume, and view rays then march
// through it.
#pragma once

#include <array>
#include <string_view>

#include "scene/capabilities.h"
#include "scene/stage.h"
#include "scene/techniques/medium_settings.h"

namespace thunderhead::scene {

// When path tracing corrects the light (docs/decisions/0012-traced-light.md).
enum class TracedLight {
  kOff,
  kAtRest,   // in a session, while the view is at rest (does not change)
  kAwaited,  // like kAtRest; in addition, an image outside a session waits for the correction
};

struct LightVolume {
  static constexpr std::string_view kName = "light_volume";
  static constexpr std::array kTransports = {Transport::kDiffusion, Transport::kConsistent,
                                             Transport::kLowAlbedo, Transport::kPaper,
                                             Transport::kPaperLowAlbedo};
  static constexpr Capabilities kCapabilities{.detail = DetailUse::kMedium,
                                              .field_optics = true,
                                              .traced_light = true,
                                              .slices = true,
                                              .sparse = true,
                                              .transports = kTransports};

  MediumSettings medium{.transport = kTransports.front(), .look = {.detail = true}};
  int slices = 128;  // samples along a ray through the medium
  TracedLight traced_light = TracedLight::kAtRest;

  bool operator==(const LightVolume&) const = default;

  const MediumSettings* Medium() const { return &medium; }
  FieldLook Look() const { return medium.look; }
  double SamplesPerPixel(double slice_share) const { return slices * slice_share; }

  Stage DirtiedSince(const LightVolume& before) const {
    if (medium.look != before.medium.look) return Stage::kExtinction;
    if (medium != before.medium || slices != before.slices) return Stage::kLight;
    return traced_light == before.traced_light ? Stage::kNothing : Stage::kView;
  }

  // Returns kOff unless the light is computed by diffusion, because path tracing corrects only
  // diffuse light.
  TracedLight TracedLightShown() const {
    return medium.transport == Transport::kDiffusion ? traced_light : TracedLight::kOff;
  }
};

}  // namespace thunderhead::scene
