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
  scene.rendering.technique = accuracy::PathNamed(scene::LightVolume::kName)->plain();
  return scene;
}

// The paths of accuracy::kPaths, for parameters of tests.
inline constexpr accuracy::Path kHalfAngle = accuracy::kPaths[0];
inline constexpr accuracy::Path kLightVolume = accuracy::kPaths[1];
inline constexpr accuracy::Path kMetaball = accuracy::kPaths[2];
inline constexpr accuracy::Path kCumulus = accuracy::kPaths[3];

inline constexpr accuracy::Mode kLowAlbedo = accuracy::kModes[0];
inline constexpr accuracy::Mode kUniformPhase = accuracy::kModes[1];
inline constexpr accuracy::Mode kPerFieldPhase = accuracy::kModes[2];
inline constexpr accuracy::Mode kWithDetail = accuracy::kModes[3];

// None for the reference and techniques that the program was extended by.
inline std::optional<accuracy::Path> PathOf(const scene::Technique& technique) {
  return accuracy::PathNamed(scene::NameOf(technique));
}

// The transport of the technique's translucent variant.
inline scene::Transport TransportOf(const scene::Technique& technique) {
  const std::string_view name = accuracy::TransportNameOf(technique);
  for (const auto& transport : accuracy::kTransports) {
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

// Its own settings, such as the number of metaballs, are the path's plain ones.
inline void SetPath(scene::Technique* technique, const accuracy::Path& path) {
  if (PathOf(*technique) == path) return;
  const scene::Technique before = *technique;
  *technique = path.plain();
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
