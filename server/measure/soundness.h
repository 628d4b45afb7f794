// Checks that hold for every scene: numbers are finite, no radiance is below 0, and neither
// transmittance nor light is ever more than what came in.
#pragma once

#include <string>
#include <vector>

#include "renderers/light_volume/light_volume_renderer.h"

namespace thunderhead::measure {

// A ray's transmittance is a product of rounded factors.
inline constexpr float kMaxShare = 1.0F + 1e-5F;

// Of what was looked at.
struct Soundness {
  std::string unsound;       // the first thing that is wrong; empty if nothing is
  double least_light = 1.0;  // smallest share of the sunlight that is left anywhere
};

// The first fault of radiance or transmittance, four floats a pixel; empty if there is none.
std::string UnsoundPicture(const std::vector<float>& eye);

// Of half-angle slicing's light buffer: four floats a texel, the share of sunlight and the optical
// depth passed first.
Soundness LightBufferSoundness(const std::vector<float>& light);

// Of the light volume, as carry.comp and arrive.comp leave it: the depth that light has passed is
// not below 0 anywhere and does not fall along any ray of the sun.
Soundness LightVolumeSoundness(const renderers::LightVolumeRenderer& renderer);

}  // namespace thunderhead::measure
