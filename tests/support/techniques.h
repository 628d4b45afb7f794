// Scenes by the axes that tests sweep: a technique, a mode of the papers, a transport. Setting one
// keeps the others, as far as the technique has them.
#pragma once

#include <optional>
#include <string_view>

#include "accuracy/named_settings.h"
#include "scene/scene.h"

namespace thunderhead::test_support {

// A scene by the light volume with consistent transport, without detail and traced light.
inline scene::Scene PlainScene() {
  scene::Scene scene;
  scene.rendering.technique = accuracy::Plain<scene::LightVolume>().settings();
  return scene;
}

// For parameters of tests.
inline constexpr auto kHalfAngle = accuracy::Plain<scene::HalfAngle>();
inline constexpr auto kLightVolume = accuracy::Plain<scene::LightVolume>();
inline constexpr auto kMetaball = accuracy::Plain<scene::Metaballs>();
inline constexpr auto kCumulus = accuracy::Plain<scene::Cumulus>();

inline constexpr accuracy::Mode kLowAlbedo = accuracy::kUniformPhaseLowAlbedoMode;
inline constexpr accuracy::Mode kUniformPhase = accuracy::kUniformPhaseTranslucentMode;
inline constexpr accuracy::Mode kPerFieldPhase = accuracy::kPerFieldPhaseTranslucentMode;
inline constexpr accuracy::Mode kWithDetail = accuracy::kPerFieldPhaseDetailTranslucentMode;

// None for the reference and techniques that the program was extended by.
inline std::optional<accuracy::PlainTechnique> PlainTechniqueOf(const scene::Technique& technique) {
  return accuracy::PlainTechniqueNamed(scene::NameOf(technique));
}

// The transport of the technique's translucent variant.
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

// Of the translucent variant; a mode of low albedo stays one.
inline void SetTransport(scene::Technique* technique, scene::Transport transport) {
  *technique = accuracy::InMode(*technique, accuracy::ModeOf(*technique), transport);
}

// Its own settings, such as the number of metaballs, are the plain ones.
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
