#include "accuracy/presets.h"

#include "accuracy/named_settings.h"
#include "base/status.h"

namespace thunderhead::accuracy {
namespace {

// docs/performance.md has what each costs and misses.
constexpr int kFastSlices = 64;

scene::Technique InPapersMode(const Mode& mode) {
  return InMode(PathNamed(scene::LightVolume::kName)->plain(), mode, scene::Transport::kConsistent);
}

}  // namespace

scene::Technique TechniqueOf(Preset preset) {
  scene::LightVolume light_volume;
  switch (preset) {
    case Preset::kFast:
      light_volume.medium.look.detail = false;
      light_volume.slices = kFastSlices;
      light_volume.traced_light = scene::TracedLight::kOff;
      return light_volume;
    case Preset::kBalanced:
      return light_volume;
    case Preset::kTrue:
      light_volume.traced_light = scene::TracedLight::kAwaited;
      return light_volume;
    case Preset::kUniformPhaseLowAlbedo:
      return InPapersMode(kModes[0]);
    case Preset::kUniformPhaseTranslucent:
      return InPapersMode(kModes[1]);
    case Preset::kPerFieldPhaseTranslucent:
      return InPapersMode(kModes[2]);
    case Preset::kPerFieldPhaseDetailTranslucent:
      return InPapersMode(kModes[3]);
  }
  THUNDERHEAD_CHECK(false, "no such preset");
}

bool IsOfThePapers(Preset preset) { return preset >= Preset::kUniformPhaseLowAlbedo; }

std::string_view NameOf(Preset preset) {
  for (const NamedPreset& named : kPresets) {
    if (named.preset == preset) return named.name;
  }
  THUNDERHEAD_CHECK(false, "no such preset");
}

std::optional<Preset> PresetNamed(std::string_view name) {
  for (const NamedPreset& named : kPresets) {
    if (named.name == name) return named.preset;
  }
  return std::nullopt;
}

}  // namespace thunderhead::accuracy
