#include "accuracy/presets.h"

#include <algorithm>

#include "base/status.h"

namespace thunderhead::accuracy {
namespace {

// The numbers of slices of two presets. docs/performance.md lists the drawing time and the error of
// each preset.
constexpr int kFastSlices = 64;
// With 128 samples, thin edges look jagged at 1280 x 640 pixels (docs/performance.md).
constexpr int kAccurateSlices = 512;

const NamedPreset& RowOf(Preset preset) {
  const auto* const row = std::ranges::find(kPresets, preset, &NamedPreset::preset);
  THUNDERHEAD_CHECK(row != kPresets.end(), "no such preset");
  return *row;
}

}  // namespace

scene::Technique TechniqueOf(Preset preset) {
  if (const Mode* mode = RowOf(preset).of_the_papers) {
    return InMode(Plain<scene::LightVolume>().settings(), *mode, scene::Transport::kConsistent);
  }
  scene::LightVolume light_volume;
  if (preset == Preset::kFast) {
    light_volume.medium.look.detail = false;
    light_volume.slices = kFastSlices;
    light_volume.traced_light = scene::TracedLight::kOff;
  } else if (preset == Preset::kAccurate) {
    light_volume.slices = kAccurateSlices;
    light_volume.traced_light = scene::TracedLight::kAwaited;
  }
  return light_volume;
}

bool IsOfThePapers(Preset preset) { return RowOf(preset).of_the_papers != nullptr; }

std::string_view NameOf(Preset preset) { return RowOf(preset).name; }

std::optional<Preset> PresetNamed(std::string_view name) {
  for (const NamedPreset& named : kPresets) {
    if (named.name == name) return named.preset;
  }
  return std::nullopt;
}

}  // namespace thunderhead::accuracy
