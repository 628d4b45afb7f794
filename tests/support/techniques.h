// Functions that set what tests vary in a scene: its technique, its mode (a variant of the
// technique that a paper describes) and its transport. Setting one of the three keeps the other
// two, if the technique has them.
#pragma once

#include <optional>
#include <string_view>

#include "accuracy/named_settings.h"
#include "scene/scene.h"

namespace thunderhead::test_support {

// Returns a scene that uses the light volume with consistent transport, without turbulent detail
// and without path-traced correction.
inline scene::Scene PlainScene() {
  scene::Scene scene;
  scene.rendering.technique = accuracy::Plain<scene::LightVolume>().settings();
  return scene;
}

// The techniques with plain settings (accuracy::Plain), and modes, as test parameters.
inline constexpr auto kHalfAngle = accuracy::Plain<scene::HalfAngle>();
inline constexpr auto kLightVolume = accuracy::Plain<scene::LightVolume>();
inline constexpr auto kMetaball = accuracy::Plain<scene::Metaballs>();
inline constexpr auto kCumulus = accuracy::Plain<scene::Cumulus>();

inline constexpr accuracy::Mode kLowAlbedo = accuracy::kUniformPhaseLowAlbedoMode;
inline constexpr accuracy::Mode kUniformPhase = accuracy::kUniformPhaseTranslucentMode;
inline constexpr accuracy::Mode kPerFieldPhase = accuracy::kPerFieldPhaseTranslucentMode;
inline constexpr accuracy::Mode kWithDetail = accuracy::kPerFieldPhaseDetailTranslucentMode;

// Returns the technique with plain settings; nothing for the reference and for techniques of server
// extensions.
inline std::optional<accuracy::PlainTechnique> PlainTechniqueOf(const scene::Technique& technique) {
  return accuracy::PlainTechniqueNamed(scene::NameOf(technique));
}

// Returns the transport of the technique's translucent variant.
inline scene::Transport TransportOf(const scene::Technique& technique) {
  const std::string_view name = accuracy::TransportNameOf(technique);
  for (const auto& transport : accuracy::kTransportNames) {
    if (transport.name == name) return transport.value;
  }
  return scene::Transport::kConsistent;
}

inline void SetMode(scene::Technique* technique, const accuracy::Mode& mode) {
  *technique = accuracy::InMode(*technique, mode, TransportOf(*technique));
}

// Sets the transport of the translucent variant. The mode stays the same; a low-albedo mode, for
// example, stays a low-albedo mode.
inline void SetTransport(scene::Technique* technique, scene::Transport transport) {
  *technique = accuracy::InMode(*technique, accuracy::ModeOf(*technique), transport);
}

// Sets the technique. Settings that only this technique has, such as the number of metaballs, get
// their plain values.
inline void SetTechnique(scene::Technique* technique, const accuracy::PlainTechnique& plain) {
  if (PlainTechniqueOf(*technique) == plain) return;
  const scene::Technique before = *technique;
  *technique = plain.settings();
  const scene::MediumSettings* from = scene::MediumSettingsOf(before);
  scene::MediumSettings* to = scene::MediumSettingsOf(technique);
  if (from != nullptr && to != nullptr) *to = *from;
  if (const auto slices = scene::SlicesOf(before)) scene::SetSlices(technique, *slices);
}

inline scene::Metaballs& MetaballsOf(scene::Technique& technique) {
  return std::get<scene::Metaballs>(technique);
}
inline scene::Cumulus& CumulusOf(scene::Technique& technique) {
  return std::get<scene::Cumulus>(technique);
}

}  // namespace thunderhead::test_support
