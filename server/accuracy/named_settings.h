// Techniques, modes and transports by name: how tables, flags and measurements tell settings apart.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "scene/scene.h"

namespace thunderhead::accuracy {

template <typename Value>
struct Named {
  Value value;
  std::string_view name;
};

// A technique in its plainest settings: consistent transport where it has a choice, neither detail
// nor traced light. Techniques are measured from there.
struct Path {
  std::string_view name;
  scene::Technique (*plain)();

  bool operator==(const Path& other) const { return name == other.name; }
};

// Without the reference, which the others are measured against.
inline constexpr std::array<Path, 4> kPaths = {{
    {scene::HalfAngle::kName, [] { return scene::Technique(scene::HalfAngle{}); }},
    {scene::LightVolume::kName,
     [] {
       return scene::Technique(
           scene::LightVolume{.medium = {}, .traced_light = scene::TracedLight::kOff});
     }},
    {scene::Metaballs::kName, [] { return scene::Technique(scene::Metaballs{}); }},
    {scene::Cumulus::kName, [] { return scene::Technique(scene::Cumulus{}); }},
}};

// Those that draw the fields cell by cell, so that their pictures have exact answers.
inline constexpr std::array<Path, 2> kFieldPaths = {{kPaths[0], kPaths[1]}};

// The path of that name; none for others.
std::optional<Path> PathNamed(std::string_view name);

// A mode of the papers' frame-rate table.
struct Mode {
  std::string_view name;
  bool per_field_phase = true;
  bool detail = false;
  bool translucent = true;
};

// In the order of Riley et al. 2003 (AMS), Table IV.
inline constexpr std::array<Mode, 4> kModes = {{
    {"uniform_phase_low_albedo", false, false, false},
    {"uniform_phase_translucent", false, false, true},
    {"per_field_phase_translucent", true, false, true},
    {"per_field_phase_detail_translucent", true, true, true},
}};

inline constexpr std::array<Named<scene::Transport>, 3> kTransports = {{
    {scene::Transport::kPaper, "paper"},
    {scene::Transport::kConsistent, "consistent"},
    {scene::Transport::kDiffusion, "diffusion"},
}};

// `technique` in that mode; `transport` is that of its translucent variant. A technique without a
// medium stays as it is.
scene::Technique InMode(scene::Technique technique, const Mode& mode, scene::Transport transport);

// The mode that a technique's settings amount to, and its transport without regard to whether it is
// translucent; those of kModes[2] and "consistent" for a technique without a medium.
const Mode& ModeOf(const scene::Technique& technique);
std::string_view TransportNameOf(const scene::Technique& technique);

// The technique that a table's names stand for; none if one of them is not known.
std::optional<scene::Technique> TechniqueNamed(std::string_view path, std::string_view mode,
                                               std::string_view transport);

// The number that a technique's pictures depend on, as tables have it: slices, samples or
// metaballs; 1 for others.
int CountOf(const scene::Technique& technique);
void SetCount(scene::Technique* technique, int count);

}  // namespace thunderhead::accuracy
