#include "accuracy/named_settings.h"

#include <algorithm>

#include "base/status.h"

namespace thunderhead::accuracy {

std::optional<Path> PathNamed(std::string_view name) {
  const auto* const found = std::find_if(kPaths.begin(), kPaths.end(),
                                         [&](const Path& path) { return path.name == name; });
  if (found == kPaths.end()) return std::nullopt;
  return *found;
}

scene::Technique InMode(scene::Technique technique, const Mode& mode, scene::Transport transport) {
  scene::MediumSettings* medium = scene::MediumSettingsOf(&technique);
  if (medium == nullptr) return technique;
  medium->look.per_field_phase = mode.per_field_phase;
  medium->look.detail = mode.detail && scene::CapabilitiesOf(technique).detail;
  medium->transport = transport;
  if (!mode.translucent) {
    medium->transport = scene::IsPaper(transport) ? scene::Transport::kPaperLowAlbedo
                                                  : scene::Transport::kLowAlbedo;
  }
  return technique;
}

const Mode& ModeOf(const scene::Technique& technique) {
  const scene::MediumSettings* medium = scene::MediumSettingsOf(technique);
  if (medium == nullptr) return kModes[2];
  if (!scene::IsTranslucent(medium->transport)) return kModes[0];
  if (!medium->look.per_field_phase) return kModes[1];
  return medium->look.detail ? kModes[3] : kModes[2];
}

std::string_view TransportNameOf(const scene::Technique& technique) {
  const scene::MediumSettings* medium = scene::MediumSettingsOf(technique);
  if (medium == nullptr) return "consistent";
  switch (medium->transport) {
    case scene::Transport::kPaper:
    case scene::Transport::kPaperLowAlbedo:
      return "paper";
    case scene::Transport::kConsistent:
    case scene::Transport::kLowAlbedo:
      return "consistent";
    case scene::Transport::kDiffusion:
      return "diffusion";
  }
  THUNDERHEAD_CHECK(false, "no such transport");
}

std::optional<scene::Technique> TechniqueNamed(std::string_view path, std::string_view mode,
                                               std::string_view transport) {
  const auto named = [](std::string_view name) {
    return [name](const auto& entry) { return entry.name == name; };
  };
  const std::optional<Path> known = PathNamed(path);
  const auto* const in_mode = std::find_if(kModes.begin(), kModes.end(), named(mode));
  const auto* const by = std::find_if(kTransports.begin(), kTransports.end(), named(transport));
  if (!known.has_value() || in_mode == kModes.end() || by == kTransports.end()) return std::nullopt;
  return InMode(known->plain(), *in_mode, by->value);
}

int CountOf(const scene::Technique& technique) {
  if (const auto* metaballs = std::get_if<scene::Metaballs>(&technique)) return metaballs->count;
  return scene::SlicesOf(technique).value_or(1);
}

void SetCount(scene::Technique* technique, int count) {
  if (auto* metaballs = std::get_if<scene::Metaballs>(technique)) metaballs->count = count;
  scene::SetSlices(technique, count);
}

}  // namespace thunderhead::accuracy
