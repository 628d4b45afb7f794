// Checks that hold for every scene: numbers are finite, no radiance is below 0, and neither
// transmittance nor the share of sunlight exceeds 1.
#pragma once

#include <string>
#include <vector>

#include "renderers/light_volume/light_volume_renderer.h"

namespace thunderhead::measure {

// Upper limit of a share: 1 plus a tolerance, because a ray's transmittance is a product of rounded
// factors.
inline constexpr float kMaxShare = 1.0F + 1e-5F;

// Upper limit of the fluence of multiply scattered light, relative to the sun's irradiance. In
// Eddington's approximation, the fluence has this value deep in an infinitely thick cloud without
// absorption, with the sun in the zenith.
inline constexpr double kMaxFluence = 5.0;

// The result of a check.
struct Soundness {
  std::string unsound;  // description of the first invalid value; empty if all values are valid
  double least_light = 1.0;  // smallest share of sunlight anywhere
};

// Describes the first invalid radiance or transmittance in `eye`, which has four floats a pixel.
// Returns an empty text if all values are valid.
std::string UnsoundPicture(const std::vector<float>& eye);

// Checks the light buffer of half-angle slicing, which has four floats a texel. The first float is
// the share of sunlight, the second an optical depth.
Soundness LightBufferSoundness(const std::vector<float>& light);

// Checks the light of the light volume after carry.comp and arrive.comp. The optical depth of
// sunlight must be 0 or more everywhere. It must not decrease along any ray of the sun. The mean
// intensity of scattered light must be 0 or more, and at most kMaxFluence / (4 pi).
Soundness LightVolumeSoundness(const renderers::LightVolumeRenderer& renderer);

// Checks the solution of diffusion transport. The fluence of sunlight must nowhere exceed
// kMaxFluence. `transport_share` is the ratio of the similarity-scaled extinction to the extinction
// for the eye.
Soundness DiffusionSoundness(const renderers::LightVolumeRenderer& renderer,
                             double transport_share);

}  // namespace thunderhead::measure
