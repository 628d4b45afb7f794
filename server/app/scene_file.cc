#include "app/scene_file.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "accuracy/presets.h"
#include "app/picture_size.h"
#include "base/named_file.h"
#include "base/status.h"
#include "frame/png_text.h"
#include "service/messages/picture_texts.h"
#include "service/messages/scene_json.h"
#include "service/messages/scene_messages.h"
#include "service/messages/technique_messages.h"

namespace thunderhead::app {
namespace {

// The number of bytes that are read from the start of a file. The scene of a picture is in front of
// its pixels, so large pictures need not be read to their end.
constexpr std::size_t kFileStart_bytes = 4 << 20;

// Returns the JSON of the scene that is stored in a picture made by the service. `what` names the
// picture in errors.
absl::StatusOr<std::string> SceneJsonIn(const std::string& what, const std::string& png) {
  auto texts = frame::TextsOf(png);
  if (!texts.ok()) return base::Annotate(texts.status(), what);
  const auto scene = texts->find(service::kSceneText);
  if (scene != texts->end()) return scene->second;
  return absl::InvalidArgumentError(absl::StrCat(
      what, " is a PNG without a scene in it; give one that thunderhead made, or a scene's JSON"));
}

// Returns the scene in a file of JSON or in a PNG. The storm of a PNG is left out, so that its
// scene can be used with another storm.
absl::StatusOr<v1::Scene> ReadFile(const std::string& flag, const std::string& path) {
  const absl::StatusOr<std::string> start = base::ReadFileStart(path, kFileStart_bytes);
  if (!start.ok()) return base::Annotate(start.status(), flag);
  const std::string what = absl::StrCat(flag, " ", path);
  std::string json = *start;
  const bool picture = frame::IsPng(json);
  if (picture) {
    THUNDERHEAD_ASSIGN_OR_RETURN(json, SceneJsonIn(what, json));
  }
  absl::StatusOr<v1::Scene> scene = service::SceneOfJson(json);
  if (!scene.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat(what, " is not a scene: ", scene.status().message(),
                     "; see proto/thunderhead/v1/scene.proto for its fields"));
  }
  if (picture) scene->clear_storm_id();
  return scene;
}

// Replaces the values in `scene` by those that `over` sets. Lists are replaced as a whole.
void Lay(const v1::Scene& over, v1::Scene& scene) {
  if (over.fields_size() > 0) scene.clear_fields();
  if (over.lights_size() > 0) scene.clear_lights();
  scene.MergeFrom(over);
}

absl::Status SetSize(const std::string& size, v1::Output& output) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const PictureSize parsed, ParsePictureSize(size));
  output.set_width_px(static_cast<std::uint32_t>(parsed.width_px));
  output.set_height_px(static_cast<std::uint32_t>(parsed.height_px));
  return absl::OkStatus();
}

// Sets the kind of camera. If the file's camera is of that kind, its settings are kept. Otherwise
// the camera gets the defaults.
absl::Status SetCamera(const std::string& kind, v1::Camera& camera) {
  if (kind == "orbit") {
    camera.mutable_orbit();
  } else if (kind == "spotter") {
    camera.mutable_spotter();
  } else if (kind == "top-down") {
    camera.mutable_top_down();
  } else {
    return absl::InvalidArgumentError(
        absl::StrCat("--camera is '", kind, "'; it must be orbit, spotter or top-down"));
  }
  return absl::OkStatus();
}

using Descriptors = std::vector<const google::protobuf::FieldDescriptor*>;

// Returns the fields of the techniques that have their own message in Rendering.
Descriptors TechniqueFields() {
  const google::protobuf::OneofDescriptor& techniques =
      *v1::Rendering::descriptor()->FindOneofByName("technique");
  Descriptors fields;
  for (int i = 0; i < techniques.field_count(); ++i) {
    const google::protobuf::FieldDescriptor* field = techniques.field(i);
    const google::protobuf::Descriptor* settings = field->message_type();
    if (settings != nullptr && settings != v1::OtherTechnique::descriptor()) {
      fields.push_back(field);
    }
  }
  return fields;
}

// Returns a list such as "a, b or c".
std::string NamesOf(const Descriptors& fields, const std::string& before_last) {
  std::string names;
  for (const auto* field : fields) {
    if (!names.empty()) names += field == fields.back() ? before_last : ", ";
    names += field->name();
  }
  return names;
}

// Sets the technique. If the file has that technique, its settings are kept. Otherwise the
// technique gets its defaults.
absl::Status SetTechnique(const std::string& name, v1::Rendering& rendering) {
  const Descriptors fields = TechniqueFields();
  const auto field = std::ranges::find(fields, name, [](const auto* each) { return each->name(); });
  if (field == fields.end()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--technique is '", name, "'; it must be ", NamesOf(fields, " or ")));
  }
  rendering.GetReflection()->MutableMessage(&rendering, *field);
  return absl::OkStatus();
}

absl::Status SetPreset(const std::string& name, v1::Rendering& rendering) {
  v1::Preset preset = v1::PRESET_UNSPECIFIED;
  const std::string value = absl::StrCat("PRESET_", absl::AsciiStrToUpper(name));
  if (!v1::Preset_Parse(value, &preset) || preset == v1::PRESET_UNSPECIFIED) {
    std::vector<std::string> names;
    names.reserve(accuracy::kPresets.size());
    for (const accuracy::NamedPreset& known : accuracy::kPresets) names.emplace_back(known.name);
    return absl::InvalidArgumentError(absl::StrCat(
        "--preset (or --quality) is '", name, "'; it must be one of ", absl::StrJoin(names, ", ")));
  }
  rendering.set_preset(preset);
  return absl::OkStatus();
}

absl::Status SetSlices(std::uint32_t slices, v1::Scene& scene) {
  v1::Rendering& rendering = *scene.mutable_rendering();
  service::FillSizesDefault(scene);
  service::FillTechniqueDefaults(rendering);
  Descriptors sliced;
  for (const auto* field : TechniqueFields()) {
    const auto* setting = field->message_type()->FindFieldByName("slices");
    if (setting == nullptr) continue;
    sliced.push_back(field);
    if (!rendering.GetReflection()->HasField(rendering, field)) continue;
    auto* settings = rendering.GetReflection()->MutableMessage(&rendering, field);
    settings->GetReflection()->SetUInt32(settings, setting, slices);
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat("--slices is for ", NamesOf(sliced, " and "),
                                                 "; omit it with other techniques"));
}

absl::Status SetRendering(const SceneFlags& flags, v1::Scene& scene) {
  if (!flags.technique.empty() && !flags.preset.empty()) {
    return absl::InvalidArgumentError(
        "--technique and --preset (or --quality) exclude each other: omit one");
  }
  if (!flags.technique.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(SetTechnique(flags.technique, *scene.mutable_rendering()));
  }
  if (!flags.preset.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(SetPreset(flags.preset, *scene.mutable_rendering()));
  }
  if (!flags.slices.has_value()) return absl::OkStatus();
  return SetSlices(*flags.slices, scene);
}

}  // namespace

void AddSceneOptions(CLI::App& command, SceneFlags& flags) {
  AddViewOptions(command, flags);
  command.add_option("--time", flags.time_index,
                     "Index of the storm's time, from 0; by default the last");
}

void AddViewOptions(CLI::App& command, SceneFlags& flags) {
  command.add_option("--scene", flags.file,
                     "Scene as Protobuf JSON, or a PNG made by thunderhead, for its scene");
  command.add_option("--size", flags.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command.add_option("--camera", flags.camera, "orbit, spotter or top-down");
}

void AddTechniqueOptions(CLI::App& command, SceneFlags& flags) {
  CLI::Option* quality =
      command
          .add_option("--quality", flags.preset,
                      "fast (half the samples, no detail), balanced (the default) or accurate (as "
                      "balanced, and a single image waits for the path-traced correction of its "
                      "light, which takes minutes)")
          ->transform([](const std::string& name) {
            // "true" is the earlier name of this quality.
            return name == "true" ? std::string("accurate") : name;
          })
          ->check(CLI::IsMember({"fast", "balanced", "accurate"}));
  CLI::Option* preset = command.add_option(
      "--preset", flags.preset, "A named setting, such as the papers' per_field_phase_translucent");
  CLI::Option* technique = command.add_option(kTechniqueFlag, flags.technique,
                                              "Technique: " + NamesOf(TechniqueFields(), " or "));
  quality->excludes(preset)->excludes(technique);
  preset->excludes(technique);
  command.add_option("--slices", flags.slices, "Number of slices, or samples along a ray");
}

absl::StatusOr<v1::Scene> ReadScene(const SceneFlags& flags) {
  v1::Scene scene;
  if (!flags.file.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(scene, ReadFile("--scene", flags.file));
  }
  if (!flags.view.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const v1::Scene view, ReadFile("--views", flags.view));
    Lay(view, scene);
  }
  if (flags.time_index.has_value()) scene.set_time_index(*flags.time_index);
  if (!flags.size.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(SetSize(flags.size, *scene.mutable_output()));
  }
  if (!flags.camera.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(SetCamera(flags.camera, *scene.mutable_camera()));
  }
  THUNDERHEAD_RETURN_IF_ERROR(SetRendering(flags, scene));
  if (flags.max_error.has_value() && flags.max_milliseconds.has_value()) {
    return absl::InvalidArgumentError(
        "--max-error and --max-milliseconds exclude each other: omit one");
  }
  if (flags.max_error.has_value()) scene.mutable_accuracy()->set_max_error(*flags.max_error);
  if (flags.max_milliseconds.has_value()) {
    scene.mutable_accuracy()->set_max_milliseconds(*flags.max_milliseconds);
  }
  return scene;
}

}  // namespace thunderhead::app
