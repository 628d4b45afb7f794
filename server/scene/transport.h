// Methods of propagating the light that a medium scatters.
#pragma once

namespace thunderhead::scene {

// How the technique propagates scattered light (docs/clouds.md and decisions 4, 6 and 9).
enum class Transport {
  kPaper,       // Riley et al. 2003 (Vis), eq. 14-17 as printed
  kConsistent,  // the exact exponential of the effective extinction
  kDiffusion,   // multiple scattering from the diffusion equation; only in the light volume
  kLowAlbedo,   // single scattering: each interaction removes light from the beam
  // Single scattering as for kLowAlbedo, with phase functions normalised over their dynamic range
  // for display.
  kPaperLowAlbedo,
};

// Returns true if the transport uses the stepwise arithmetic and the display of Riley et al. 2003
// instead of the exact exponential.
constexpr bool IsPaper(Transport transport) {
  return transport == Transport::kPaper || transport == Transport::kPaperLowAlbedo;
}

// Returns true if light scattered forward continues through the medium.
constexpr bool IsTranslucent(Transport transport) {
  return transport != Transport::kLowAlbedo && transport != Transport::kPaperLowAlbedo;
}

}  // namespace thunderhead::scene
