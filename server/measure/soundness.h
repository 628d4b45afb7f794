// Checks that hold for every scene: numbers are finite, no radiance is below 0, and neither
// transmittance nor the share of sunlight exceeds 1.
#pragma once

#include <string>
#include <vector>

#include "renderers/light_volume/light_volume_renderer.h"

namespace thunderhead::measure {

// 1 plus a tolerance, because a ray's transmittance is a product of rounded factors.
inline constexpr float kMaxShare = 1.0F + 1e-5F;

// Ratio of the fluence of multiply scattered light to the sun's irradiance, deep in an infinite
// conservative cloud with the sun in the zenith (Eddington).
inline constexpr double kMaxFluence = 5.0;

// The result of a check.
struct Soundness {
  std::string unsound;       // the first invalid value; empty if there is none
  double least_light = 1.0;  // smallest share of sunlight anywhere
};

// Returns the first fault of radiance or transmittance, with four floats per pixel; empty if there
// is none.
std::string UnsoundPicture(const std::vector<float>& eye);

// Checks half-angle slicing's light buffer, with four floats per texel. The first two are the share
// of sunlight and its optical depth.
Soundness LightBufferSoundness(const std::vector<float>& light);

// Checks the light volume after carry.comp and arrive.comp. The optical depth of sunlight must be 0
// or more everywhere and must not decrease along any ray of the sun.
Soundness LightVolumeSoundness(const renderers::LightVolumeRenderer& renderer);

// Checks the solution of diffusion transport, which has as many cells as the medium. The fluence of
// sunlight must nowhere exceed that deep in an infinite conservative cloud. `transport_share` is
// the ratio of the similarity-scaled extinction to the eye's.
Soundness DiffusionSoundness(const renderers::LightVolumeRenderer& renderer,
                             double transport_share);

}  // namespace thunderhead::measure
