// The names of techniques, modes and transports (ways of solving the light), by which tables, flags
// and measurements identify them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>

#include "scene/scene.h"

namespace thunderhead::accuracy {

template <typename Value>
struct Named {
  Value value;
  std::string_view name;
};

// A technique with its simplest settings: consistent transport if the technique has several
// transports, no detail and no path-traced correction. Measurements start from these settings.
struct PlainTechnique {
  std::string_view name;
  scene::Technique (*settings)();

  bool operator==(const PlainTechnique& other) const { return name == other.name; }
};

template <typename Settings>
constexpr PlainTechnique Plain() {
  return {Settings::kName, [] {
            Settings settings;
            if constexpr (requires { settings.medium; }) settings.medium = {};
            if constexpr (requires { settings.traced_light; }) {
              settings.traced_light = scene::TracedLight::kOff;
            }
            return scene::Technique(settings);
          }};
}

namespace internal {

// Returns true for techniques that have rows in the tables: all that have settings, except the
// reference, with which the others are compared.
template <typename Settings>
constexpr bool IsMeasured() {
  if constexpr (requires { Settings::kName; }) return Settings::kCapabilities.images;
  return false;
}

template <typename... Settings>
constexpr auto MeasuredOf(std::type_identity<std::variant<Settings...>> /*techniques*/) {
  std::array<PlainTechnique, (std::size_t{IsMeasured<Settings>()} + ...)> measured{};
  std::size_t count = 0;
  const auto add = [&]<typename One>(std::type_identity<One>) {
    if constexpr (IsMeasured<One>()) measured[count++] = Plain<One>();
  };
  (add(std::type_identity<Settings>{}), ...);
  return measured;
}

}  // namespace internal

// The techniques that have rows in tables, in the order of scene::Technique.
inline constexpr auto kPlainTechniques =
    internal::MeasuredOf(std::type_identity<scene::Technique>{});

// The techniques that draw the cells of the fields, so that exact solutions for their pictures
// exist.
inline constexpr std::array<PlainTechnique, 2> kCellTechniques = {Plain<scene::HalfAngle>(),
                                                                  Plain<scene::LightVolume>()};

// Returns the technique with that name, or nothing for an unknown name.
std::optional<PlainTechnique> PlainTechniqueNamed(std::string_view name);

// A mode (combination of medium settings) in the frame-rate table of the papers.
struct Mode {
  std::string_view name;
  bool per_field_phase = true;
  bool detail = false;
  bool translucent = true;
};

inline constexpr Mode kUniformPhaseLowAlbedoMode = {"uniform_phase_low_albedo", false, false,
                                                    false};
inline constexpr Mode kUniformPhaseTranslucentMode = {"uniform_phase_translucent", false, false,
                                                      true};
inline constexpr Mode kPerFieldPhaseTranslucentMode = {"per_field_phase_translucent", true, false,
                                                       true};
inline constexpr Mode kPerFieldPhaseDetailTranslucentMode = {"per_field_phase_detail_translucent",
                                                             true, true, true};

// The modes in the order of Riley et al. 2003 (AMS), Table IV.
inline constexpr std::array<Mode, 4> kModes = {
    {kUniformPhaseLowAlbedoMode, kUniformPhaseTranslucentMode, kPerFieldPhaseTranslucentMode,
     kPerFieldPhaseDetailTranslucentMode}};

// The transports of translucent modes, with their names in tables.
inline constexpr std::array<Named<scene::Transport>, 3> kTransportNames = {{
    {scene::Transport::kPaper, "paper"},
    {scene::Transport::kConsistent, "consistent"},
    {scene::Transport::kDiffusion, "diffusion"},
}};

// Returns `technique` with the settings of `mode`. If the mode is translucent, its transport is
// `transport`. A technique without a medium is returned unchanged.
scene::Technique InMode(scene::Technique technique, const Mode& mode, scene::Transport transport);

// Returns true if the technique supports the transport, or has no medium.
bool ShowsTransport(const scene::Technique& technique, scene::Transport transport);

// These functions return the mode of a technique's settings and the name of its transport. The
// transport is returned even if the mode is not translucent. For a technique without a medium they
// return kPerFieldPhaseTranslucentMode and "consistent".
const Mode& ModeOf(const scene::Technique& technique);
std::string_view TransportNameOf(const scene::Technique& technique);

// Returns the technique for the three names in a table's row, or nothing if a name is unknown.
std::optional<scene::Technique> TechniqueNamed(std::string_view name, std::string_view mode,
                                               std::string_view transport);

}  // namespace thunderhead::accuracy
