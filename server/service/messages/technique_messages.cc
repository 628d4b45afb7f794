#include "service/messages/technique_messages.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "accuracy/presets.h"
#include "base/error_details.h"
#include "base/status.h"
#include "service/messages/enum_tables.h"

namespace thunderhead::service {
namespace {

constexpr std::array kTransports = {
    std::pair{v1::TRANSPORT_CONSISTENT, scene::Transport::kConsistent},
    std::pair{v1::TRANSPORT_PAPER, scene::Transport::kPaper},
    std::pair{v1::TRANSPORT_DIFFUSION, scene::Transport::kDiffusion},
    std::pair{v1::TRANSPORT_LOW_ALBEDO, scene::Transport::kLowAlbedo},
    std::pair{v1::TRANSPORT_PAPER_LOW_ALBEDO, scene::Transport::kPaperLowAlbedo},
};
constexpr std::array kTracedLights = {
    std::pair{v1::TRACED_LIGHT_AT_REST, scene::TracedLight::kAtRest},
    std::pair{v1::TRACED_LIGHT_OFF, scene::TracedLight::kOff},
    std::pair{v1::TRACED_LIGHT_AWAITED, scene::TracedLight::kAwaited},
};
constexpr std::array kCumulusSources = {
    std::pair{v1::Cumulus::SOURCE_STORM, scene::CumulusSource::kStorm},
    std::pair{v1::Cumulus::SOURCE_CAULIFLOWER, scene::CumulusSource::kCauliflower},
    std::pair{v1::Cumulus::SOURCE_FAIR_WEATHER_CUMULUS, scene::CumulusSource::kFairWeatherCumulus},
    std::pair{v1::Cumulus::SOURCE_CONGESTUS, scene::CumulusSource::kCongestus},
    std::pair{v1::Cumulus::SOURCE_CUMULUS_FIELD, scene::CumulusSource::kCumulusField},
    std::pair{v1::Cumulus::SOURCE_ELLIPSOID, scene::CumulusSource::kEllipsoid},
};
constexpr std::array kCumulusComponents = {
    std::pair{v1::Cumulus::COMPONENT_ALL, scene::CumulusComponent::kAll},
    std::pair{v1::Cumulus::COMPONENT_DIRECT, scene::CumulusComponent::kDirect},
    std::pair{v1::Cumulus::COMPONENT_INTER_REFLECTION, scene::CumulusComponent::kInterReflection},
    std::pair{v1::Cumulus::COMPONENT_AMBIENT, scene::CumulusComponent::kAmbient},
    std::pair{v1::Cumulus::COMPONENT_CORONA, scene::CumulusComponent::kCorona},
    std::pair{v1::Cumulus::COMPONENT_BALLS, scene::CumulusComponent::kBalls},
};
constexpr std::array kPresets = {
    std::pair{v1::PRESET_BALANCED, accuracy::Preset::kBalanced},
    std::pair{v1::PRESET_FAST, accuracy::Preset::kFast},
    std::pair{v1::PRESET_ACCURATE, accuracy::Preset::kAccurate},
    std::pair{v1::PRESET_UNIFORM_PHASE_LOW_ALBEDO, accuracy::Preset::kUniformPhaseLowAlbedo},
    std::pair{v1::PRESET_UNIFORM_PHASE_TRANSLUCENT, accuracy::Preset::kUniformPhaseTranslucent},
    std::pair{v1::PRESET_PER_FIELD_PHASE_TRANSLUCENT, accuracy::Preset::kPerFieldPhaseTranslucent},
    std::pair{v1::PRESET_PER_FIELD_PHASE_DETAIL_TRANSLUCENT,
              accuracy::Preset::kPerFieldPhaseDetailTranslucent},
};

// Checks the transport of the technique whose field is `path` and whose settings have the type
// `Settings`.
template <typename Settings>
absl::Status CheckTransport(const std::string& path, v1::Transport given) {
  std::vector<v1::Transport> accepted;
  for (const scene::Transport transport : Settings::kCapabilities.transports) {
    accepted.push_back(MessageOf(kTransports, transport));
  }
  if (given == v1::TRANSPORT_UNSPECIFIED ||
      std::find(accepted.begin(), accepted.end(), given) != accepted.end()) {
    return absl::OkStatus();
  }
  const std::string names = absl::StrJoin(accepted, ", ", [](std::string* out, v1::Transport one) {
    out->append(v1::Transport_Name(one));
  });
  return base::InvalidField(
      absl::StrCat("scene.rendering.", path, ".transport"),
      absl::StrCat("is ", v1::Transport_Name(given),
                   ", which this technique does not support; it must be one of ", names),
      "TRANSPORT_NOT_SHOWN");
}

absl::Status CheckOther(const v1::OtherTechnique& other,
                        const std::vector<scene::TechniqueInfo>& known) {
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const scene::TechniqueInfo& technique : known) names.push_back(technique.name);
  const bool found = std::find(names.begin(), names.end(), other.name()) != names.end();
  const v1::Rendering& fields = v1::Rendering::default_instance();
  const bool own = fields.GetDescriptor()->FindFieldByName(other.name()) != nullptr;
  if (found && !own) return absl::OkStatus();
  return base::InvalidField(
      "scene.rendering.other.name",
      absl::StrCat(
          "is '", other.name(), "'; ",
          found ? "that technique has a field of its own in scene.rendering"
                : absl::StrCat("the server has the techniques ", absl::StrJoin(names, ", "))),
      "UNKNOWN_TECHNIQUE");
}

// Sets the settings that all techniques for a medium share.
template <typename Message>
void SetMedium(const scene::MediumSettings& settings, Message& message) {
  message.set_transport(MessageOf(kTransports, settings.transport));
  message.set_theta_f_deg(static_cast<float>(settings.theta_f_deg));
  message.set_per_field_phase(settings.look.per_field_phase);
  message.set_false_colors(settings.look.false_colors);
}

template <typename Message>
scene::MediumSettings ToMedium(const Message& message) {
  scene::MediumSettings settings;
  settings.transport = ValueOf(kTransports, message.transport());
  settings.theta_f_deg = message.theta_f_deg();
  settings.look.per_field_phase = message.per_field_phase();
  settings.look.false_colors = message.false_colors();
  return settings;
}

void SetSettings(const scene::LightVolume& settings, v1::Rendering& rendering) {
  v1::LightVolume& message = *rendering.mutable_light_volume();
  SetMedium(settings.medium, message);
  message.set_detail(settings.medium.look.detail);
  message.set_slices(static_cast<std::uint32_t>(settings.slices));
  message.set_traced_light(MessageOf(kTracedLights, settings.traced_light));
}

void SetSettings(const scene::HalfAngle& settings, v1::Rendering& rendering) {
  v1::HalfAngle& message = *rendering.mutable_half_angle();
  SetMedium(settings.medium, message);
  message.set_detail(settings.medium.look.detail);
  message.set_slices(static_cast<std::uint32_t>(settings.slices));
}

void SetSettings(const scene::Metaballs& settings, v1::Rendering& rendering) {
  v1::Metaballs& message = *rendering.mutable_metaball();
  SetMedium(settings.medium, message);
  message.set_count(static_cast<std::uint32_t>(settings.count));
  message.set_isotropic(settings.isotropic);
  message.set_albedo(static_cast<float>(settings.albedo));
  message.set_optical_depth(static_cast<float>(settings.optical_depth));
}

void SetSettings(const scene::Cumulus& settings, v1::Rendering& rendering) {
  v1::Cumulus& message = *rendering.mutable_cumulus();
  message.set_source(MessageOf(kCumulusSources, settings.source));
  message.set_seed(settings.seed);
  message.set_scales(static_cast<std::uint32_t>(settings.scales));
  message.set_least_extinction_per_m(settings.least_extinction_per_m);
  message.set_corona(settings.corona);
  message.set_trap(settings.trap);
  message.set_transmission(settings.transmission);
  message.set_roughness(settings.roughness);
  message.set_component(MessageOf(kCumulusComponents, settings.component));
}

void SetSettings(const scene::Reference& settings, v1::Rendering& rendering) {
  v1::Reference& message = *rendering.mutable_reference();
  message.set_per_field_phase(settings.per_field_phase);
  message.set_false_colors(settings.false_colors);
}

void SetSettings(const scene::OtherTechnique& settings, v1::Rendering& rendering) {
  v1::OtherTechnique& message = *rendering.mutable_other();
  message.set_name(settings.name);
  message.mutable_numbers()->insert(settings.numbers.begin(), settings.numbers.end());
}

scene::LightVolume ToSettings(const v1::LightVolume& message) {
  scene::LightVolume settings;
  settings.medium = ToMedium(message);
  settings.medium.look.detail = message.detail();
  settings.slices = static_cast<int>(message.slices());
  settings.traced_light = ValueOf(kTracedLights, message.traced_light());
  return settings;
}

scene::HalfAngle ToSettings(const v1::HalfAngle& message) {
  scene::HalfAngle settings;
  settings.medium = ToMedium(message);
  settings.medium.look.detail = message.detail();
  settings.slices = static_cast<int>(message.slices());
  return settings;
}

scene::Metaballs ToSettings(const v1::Metaballs& message) {
  scene::Metaballs settings;
  settings.medium = ToMedium(message);
  settings.count = static_cast<int>(message.count());
  settings.isotropic = message.isotropic();
  settings.albedo = message.albedo();
  settings.optical_depth = message.optical_depth();
  return settings;
}

scene::Cumulus ToSettings(const v1::Cumulus& message) {
  scene::Cumulus settings;
  settings.source = ValueOf(kCumulusSources, message.source());
  settings.seed = message.seed();
  settings.scales = static_cast<int>(message.scales());
  settings.least_extinction_per_m = message.least_extinction_per_m();
  settings.corona = message.corona();
  settings.trap = message.trap();
  settings.transmission = message.transmission();
  settings.roughness = message.roughness();
  settings.component = ValueOf(kCumulusComponents, message.component());
  return settings;
}

scene::OtherTechnique ToSettings(const v1::OtherTechnique& message) {
  return {message.name(), {message.numbers().begin(), message.numbers().end()}};
}

// Returns the technique in `rendering`, with its defaults.
scene::Technique DefaultsOf(const v1::Rendering& rendering) {
  switch (rendering.technique_case()) {
    case v1::Rendering::kHalfAngle:
      return scene::HalfAngle{};
    case v1::Rendering::kMetaball:
      return scene::Metaballs{};
    case v1::Rendering::kCumulus:
      return scene::Cumulus{};
    case v1::Rendering::kReference:
      return scene::Reference{};
    case v1::Rendering::kOther:
      return scene::OtherTechnique{};
    case v1::Rendering::kPreset:
      return accuracy::TechniqueOf(ValueOf(kPresets, rendering.preset()));
    case v1::Rendering::kLightVolume:
      break;
    case v1::Rendering::TECHNIQUE_NOT_SET:
      return accuracy::TechniqueOf(accuracy::kDefaultPreset);
  }
  return scene::LightVolume{};
}

}  // namespace

absl::Status CheckRendering(const v1::Rendering& rendering,
                            const std::vector<scene::TechniqueInfo>& known) {
  switch (rendering.technique_case()) {
    case v1::Rendering::kLightVolume:
      return CheckTransport<scene::LightVolume>("light_volume",
                                                rendering.light_volume().transport());
    case v1::Rendering::kHalfAngle:
      return CheckTransport<scene::HalfAngle>("half_angle", rendering.half_angle().transport());
    case v1::Rendering::kMetaball:
      return CheckTransport<scene::Metaballs>("metaball", rendering.metaball().transport());
    case v1::Rendering::kOther:
      return CheckOther(rendering.other(), known);
    default:
      return absl::OkStatus();
  }
}

void FillTechniqueDefaults(v1::Rendering& rendering) {
  v1::Rendering filled;
  ToMessage(DefaultsOf(rendering), filled);
  if (rendering.technique_case() != v1::Rendering::kPreset) {
    const bool traced_light_given =
        rendering.light_volume().traced_light() != v1::TRACED_LIGHT_UNSPECIFIED;
    // The given settings replace the defaults. An enumerator with the value 0 counts as absent.
    filled.MergeFrom(rendering);
    const bool diffuses = filled.light_volume().transport() == v1::TRANSPORT_DIFFUSION;
    if (filled.has_light_volume() && !traced_light_given && !diffuses) {
      filled.mutable_light_volume()->set_traced_light(v1::TRACED_LIGHT_OFF);
    }
  }
  rendering = filled;
}

bool IsOfThePapers(const v1::Rendering& rendering) {
  return rendering.technique_case() == v1::Rendering::kPreset &&
         accuracy::IsOfThePapers(ValueOf(kPresets, rendering.preset()));
}

scene::Technique ToTechnique(const v1::Rendering& rendering) {
  switch (rendering.technique_case()) {
    case v1::Rendering::kLightVolume:
      return ToSettings(rendering.light_volume());
    case v1::Rendering::kHalfAngle:
      return ToSettings(rendering.half_angle());
    case v1::Rendering::kMetaball:
      return ToSettings(rendering.metaball());
    case v1::Rendering::kCumulus:
      return ToSettings(rendering.cumulus());
    case v1::Rendering::kReference:
      return scene::Reference{rendering.reference().per_field_phase(),
                              rendering.reference().false_colors()};
    case v1::Rendering::kOther:
      return ToSettings(rendering.other());
    case v1::Rendering::kPreset:
    case v1::Rendering::TECHNIQUE_NOT_SET:
      break;
  }
  return DefaultsOf(rendering);
}

void ToMessage(const scene::Technique& technique, v1::Rendering& message) {
  std::visit([&](const auto& settings) { SetSettings(settings, message); }, technique);
}

void ToMessage(const scene::TechniqueInfo& technique, v1::TechniqueDescription& message) {
  message.set_name(technique.name);
  message.set_shows_lights(technique.capabilities.lights);
  message.set_shows_detail(technique.capabilities.detail != scene::DetailUse::kNone);
  message.set_shows_field_optics(technique.capabilities.field_optics);
  message.set_shows_traced_light(technique.capabilities.traced_light);
  message.set_has_slices(technique.capabilities.slices);
  message.set_draws_images(technique.capabilities.images);
  for (const scene::Transport transport : technique.capabilities.transports) {
    message.add_transports(MessageOf(kTransports, transport));
  }
}

void AddPresets(v1::GetServerInfoResponse& response) {
  for (const accuracy::NamedPreset& named : accuracy::kPresets) {
    v1::PresetDescription& description = *response.add_presets();
    description.set_preset(MessageOf(kPresets, named.preset));
    ToMessage(accuracy::TechniqueOf(named.preset), *description.mutable_rendering());
  }
}

}  // namespace thunderhead::service
