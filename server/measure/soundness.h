// Checks that hold for every scene: numbers are finite, no radiance is below 0, and neither
// transmittance nor the share of sunlight exceeds 1.
#pragma once

#include <string>
#include <vector>

#include "renderers/light_volume/light_volume_renderer.h"

namespace thunderhead::measure {

// 1 plus tolerance: a ray's transmittance is a product of rounded factors.
inline constexpr float kMaxShare = 1.0F + 1e-5F;

// Fluence of light scattered many times, over the sun's irradiance: deep in an infinite
// conservative cloud with the sun in the zenith (Eddington).
inline constexpr double kMaxFluence = 5.0;

// The result of a check.
struct Soundness {
  std::string unsound;       // the first invalid value; empty if there is none
  double least_light = 1.0;  // smallest share of sunlight anywhere
};

// The first fault of radiance or transmittance, four floats a pixel; empty if there is none.
std::string UnsoundPicture(const std::vector<float>& eye);

// Checks half-angle slicing's light buffer: four floats a texel, of which the first two are the
// share of sunlight and its optical depth.
Soundness LightBufferSoundness(const std::vector<float>& light);

// Checks the light volume after carry.comp and arrive.comp: the optical depth of sunlight is
// nowhere below 0 and does not fall along any ray of the sun.
Soundness LightVolumeSoundness(const renderers::LightVolumeRenderer& renderer);

// Checks the solution of diffusion transport, in as many cells as the medium's: the fluence of
// sunlight is nowhere more than that deep in an infinite conservative cloud. `transport_share` is
// the similarity-scaled extinction over the eye's.
Soundness DiffusionSoundness(const renderers::LightVolumeRenderer& renderer,
                             double transport_share);

}  // namespace thunderhead::measure
