// Ways to carry the light that a medium scatters.
#pragma once

namespace thunderhead::scene {

// How the light that the medium scatters is carried (docs/clouds.md and decisions 4, 6 and 9).
enum class Transport {
  kPaper,           // Riley et al. 2003 (Vis), eq. 14-17 as printed
  kConsistent,      // the exact exponential of the effective extinction
  kDiffusion,       // multiple scattering from the diffusion equation; the light volume alone
  kLowAlbedo,       // single scattering: light that strikes a particle is lost to all others
  kPaperLowAlbedo,  // the same, phase functions normalised over their dynamic range for display
};

// With the paper's step by step arithmetic and display, not the exact exponential.
constexpr bool IsPaper(Transport transport) {
  return transport == Transport::kPaper || transport == Transport::kPaperLowAlbedo;
}

// Light scattered forward goes on.
constexpr bool IsTranslucent(Transport transport) {
  return transport != Transport::kLowAlbedo && transport != Transport::kPaperLowAlbedo;
}

}  // namespace thunderhead::scene
