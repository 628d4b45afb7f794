// Settings that techniques have in common which draw the storm's fields as a medium.
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

// Which of the fields' own properties a picture shows.
struct FieldLook {
  bool per_field_phase = true;  // false: the phase function of cloud water for every field
  bool detail = false;          // turbulent detail finer than the grid
  bool false_colors = false;

  bool operator==(const FieldLook&) const = default;
};

struct MediumSettings {
  Transport transport = Transport::kConsistent;
  // Light scattered by less than half of this angle counts as unscattered (theta_f of the paper).
  double theta_f_deg = 20.0;
  FieldLook look;

  bool operator==(const MediumSettings&) const = default;
};

}  // namespace thunderhead::scene
