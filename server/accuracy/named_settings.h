// Techniques, modes and transports by name, as tables, flags and measurements identify them.
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

// A technique in its plainest settings: consistent transport if it has a choice, no detail and no
// traced light. Measurements start from these settings.
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

// Returns true for techniques with their own settings, except the reference, which the others are
// measured against.
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

// The techniques that draw the fields cell by cell, so that their pictures have exact solutions.
inline constexpr std::array<PlainTechnique, 2> kCellTechniques = {Plain<scene::HalfAngle>(),
                                                                  Plain<scene::LightVolume>()};

// Returns the technique of that name; none for an unknown name.
std::optional<PlainTechnique> PlainTechniqueNamed(std::string_view name);

// A mode of the papers' frame-rate table.
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

// The transports of translucent modes by their names in tables.
inline constexpr std::array<Named<scene::Transport>, 3> kTransportNames = {{
    {scene::Transport::kPaper, "paper"},
    {scene::Transport::kConsistent, "consistent"},
    {scene::Transport::kDiffusion, "diffusion"},
}};

// Returns `technique` in that mode. `transport` is the transport of its translucent variant. A
// technique without a medium does not change.
scene::Technique InMode(scene::Technique technique, const Mode& mode, scene::Transport transport);

// Returns true if the technique supports that transport or draws no medium.
bool ShowsTransport(const scene::Technique& technique, scene::Transport transport);

// Return the mode of a technique's settings and the name of its transport, whether or not it is
// translucent. For a technique without a medium they return kPerFieldPhaseTranslucentMode and
// "consistent".
const Mode& ModeOf(const scene::Technique& technique);
std::string_view TransportNameOf(const scene::Technique& technique);

// Returns the technique of a table's names; none if a name is unknown.
std::optional<scene::Technique> TechniqueNamed(std::string_view name, std::string_view mode,
                                               std::string_view transport);

}  // namespace thunderhead::accuracy
