// Named settings (presets). Three presets differ in speed and accuracy. The others are the modes of
// the papers' frame-rate table (Riley et al. 2003, AMS, Table IV), drawn with the light volume.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "accuracy/named_settings.h"
#include "scene/technique.h"

namespace thunderhead::accuracy {

enum class Preset {
  kFast,
  kBalanced,
  kAccurate,
  kUniformPhaseLowAlbedo,
  kUniformPhaseTranslucent,
  kPerFieldPhaseTranslucent,
  kPerFieldPhaseDetailTranslucent,
};

struct NamedPreset {
  Preset preset;
  std::string_view name;
  const Mode* of_the_papers = nullptr;  // the mode in the papers' table, or null
};

// All presets, in the order in which they are offered to users.
inline constexpr std::array<NamedPreset, 7> kPresets = {{
    {Preset::kFast, "fast"},
    {Preset::kBalanced, "balanced"},
    {Preset::kAccurate, "accurate"},
    {Preset::kUniformPhaseLowAlbedo, kUniformPhaseLowAlbedoMode.name, &kUniformPhaseLowAlbedoMode},
    {Preset::kUniformPhaseTranslucent, kUniformPhaseTranslucentMode.name,
     &kUniformPhaseTranslucentMode},
    {Preset::kPerFieldPhaseTranslucent, kPerFieldPhaseTranslucentMode.name,
     &kPerFieldPhaseTranslucentMode},
    {Preset::kPerFieldPhaseDetailTranslucent, kPerFieldPhaseDetailTranslucentMode.name,
     &kPerFieldPhaseDetailTranslucentMode},
}};

inline constexpr Preset kDefaultPreset = Preset::kBalanced;

// Returns the technique and settings of the preset.
scene::Technique TechniqueOf(Preset preset);

// Returns true if the preset is one of the modes of the papers' table.
bool IsOfThePapers(Preset preset);

std::string_view NameOf(Preset preset);
std::optional<Preset> PresetNamed(std::string_view name);

}  // namespace thunderhead::accuracy
