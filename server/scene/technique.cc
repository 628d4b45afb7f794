#include "scene/technique.h"

#include <type_traits>

namespace thunderhead::scene {

std::string_view NameOf(const Technique& technique) {
  return std::visit(
      [](const auto& settings) -> std::string_view {
        if constexpr (std::is_same_v<std::decay_t<decltype(settings)>, OtherTechnique>) {
          return settings.name;
        } else {
          return settings.kName;
        }
      },
      technique);
}

const Capabilities& CapabilitiesOf(const Technique& technique) {
  return std::visit(
      [](const auto& settings) -> const Capabilities& { return settings.kCapabilities; },
      technique);
}

const MediumSettings* MediumSettingsOf(const Technique& technique) {
  return std::visit([](const auto& settings) { return settings.Medium(); }, technique);
}

MediumSettings MediumSettingsOrDefault(const Technique& technique) {
  const MediumSettings* own = MediumSettingsOf(technique);
  return own != nullptr ? *own : MediumSettings{};
}

MediumSettings* MediumSettingsOf(Technique* technique) {
  return std::visit(
      [](auto& settings) -> MediumSettings* {
        if constexpr (requires { settings.medium; }) {
          return &settings.medium;
        } else {
          return nullptr;
        }
      },
      *technique);
}

FieldLook FieldLookOf(const Technique& technique) {
  FieldLook look = std::visit([](const auto& settings) { return settings.Look(); }, technique);
  // Metaballs have this setting, too, but draw no medium that could have detail.
  look.detail = look.detail && CapabilitiesOf(technique).detail == DetailUse::kMedium;
  return look;
}

bool IsTraced(const Technique& technique) { return !CapabilitiesOf(technique).images; }

std::optional<int> SlicesOf(const Technique& technique) {
  return std::visit(
      [](const auto& settings) -> std::optional<int> {
        if constexpr (requires { settings.slices; }) {
          return settings.slices;
        } else {
          return std::nullopt;
        }
      },
      technique);
}

void SetSlices(Technique* technique, int slices) {
  std::visit(
      [slices](auto& settings) {
        if constexpr (requires { settings.slices; }) settings.slices = slices;
      },
      *technique);
}

int CountOf(const Technique& technique) {
  return std::visit(
      [&technique](const auto& settings) {
        if constexpr (requires { settings.count; }) {
          return settings.count;
        } else {
          return SlicesOf(technique).value_or(1);
        }
      },
      technique);
}

void SetCount(Technique* technique, int count) {
  std::visit(
      [count](auto& settings) {
        if constexpr (requires { settings.count; }) settings.count = count;
        if constexpr (requires { settings.slices; }) settings.slices = count;
      },
      *technique);
}

double SamplesPerPixel(const Technique& technique, double slice_share) {
  return std::visit(
      [slice_share](const auto& settings) { return settings.SamplesPerPixel(slice_share); },
      technique);
}

TracedLight TracedLightOf(const Technique& technique) {
  return std::visit(
      [](const auto& settings) {
        if constexpr (requires { settings.TracedLightShown(); }) {
          return settings.TracedLightShown();
        } else {
          return TracedLight::kOff;
        }
      },
      technique);
}

void SetTracedLight(Technique* technique, TracedLight traced_light) {
  std::visit(
      [traced_light](auto& settings) {
        if constexpr (requires { settings.traced_light; }) settings.traced_light = traced_light;
      },
      *technique);
}

Stage FirstDirtyStage(const Technique& before, const Technique& after) {
  if (before.index() == after.index()) {
    return std::visit(
        [&before](const auto& settings) {
          using Settings = std::decay_t<decltype(settings)>;
          return settings.DirtiedSince(std::get<Settings>(before));
        },
        after);
  }
  // All techniques that draw a medium use the same extinction, so a change between them keeps it.
  const bool media = MediumSettingsOf(before) != nullptr && MediumSettingsOf(after) != nullptr;
  const bool same_look = FieldLookOf(before) == FieldLookOf(after);
  return media && same_look ? Stage::kLight : Stage::kExtinction;
}

}  // namespace thunderhead::scene
