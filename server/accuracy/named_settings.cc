#include "accuracy/named_settings.h"

#include <algorithm>

#include "base/status.h"

namespace thunderhead::accuracy {

std::optional<PlainTechnique> PlainTechniqueNamed(std::string_view name) {
  const auto* const found = std::ranges::find(kPlainTechniques, name, &PlainTechnique::name);
  if (found == kPlainTechniques.end()) return std::nullopt;
  return *found;
}

scene::Technique InMode(scene::Technique technique, const Mode& mode, scene::Transport transport) {
  scene::MediumSettings* medium = scene::MediumSettingsOf(&technique);
  if (medium == nullptr) return technique;
  medium->look.per_field_phase = mode.per_field_phase;
  medium->look.detail =
      mode.detail && scene::CapabilitiesOf(technique).detail == scene::DetailUse::kMedium;
  medium->transport = transport;
  if (!mode.translucent) {
    medium->transport = scene::IsPaper(transport) ? scene::Transport::kPaperLowAlbedo
                                                  : scene::Transport::kLowAlbedo;
  }
  return technique;
}

bool ShowsTransport(const scene::Technique& technique, scene::Transport transport) {
  const auto& shown = scene::CapabilitiesOf(technique).transports;
  return scene::MediumSettingsOf(technique) == nullptr ||
         std::find(shown.begin(), shown.end(), transport) != shown.end();
}

const Mode& ModeOf(const scene::Technique& technique) {
  const scene::MediumSettings* medium = scene::MediumSettingsOf(technique);
  if (medium == nullptr) return kPerFieldPhaseTranslucentMode;
  if (!scene::IsTranslucent(medium->transport)) return kUniformPhaseLowAlbedoMode;
  if (!medium->look.per_field_phase) return kUniformPhaseTranslucentMode;
  return medium->look.detail ? kPerFieldPhaseDetailTranslucentMode : kPerFieldPhaseTranslucentMode;
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

std::optional<scene::Technique> TechniqueNamed(std::string_view name, std::string_view mode,
                                               std::string_view transport) {
  const std::optional<PlainTechnique> known = PlainTechniqueNamed(name);
  const auto* const in_mode = std::ranges::find(kModes, mode, &Mode::name);
  const auto* const by =
      std::ranges::find(kTransportNames, transport, &Named<scene::Transport>::name);
  if (!known.has_value() || in_mode == kModes.end() || by == kTransportNames.end()) {
    return std::nullopt;
  }
  return InMode(known->settings(), *in_mode, by->value);
}

}  // namespace thunderhead::accuracy
