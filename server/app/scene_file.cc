#include "app/scene_file.h"

#include <google/protobuf/util/json_util.h>

#include <fstream>
#include <iterator>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "app/picture_size.h"
#include "base/status.h"

namespace thunderhead::app {
namespace {

absl::StatusOr<v1::Scene> ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string json(std::istreambuf_iterator<char>(file), {});
  if (!file.good() && json.empty()) {
    return absl::InvalidArgumentError(absl::StrCat("--scene ", path, " cannot be read"));
  }
  v1::Scene scene;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &scene);
  if (status.ok()) return scene;
  // The parser quotes the file, line ends and all.
  std::string why(status.message());
  absl::RemoveExtraAsciiWhitespace(&why);
  return absl::InvalidArgumentError(
      absl::StrCat("--scene ", path, " is not a scene: ", why,
                   "; see proto/thunderhead/v1/scene.proto for its fields"));
}

absl::Status SetSize(const std::string& size, v1::Output& output) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const PictureSize parsed, ParsePictureSize(size));
  output.set_width_px(static_cast<std::uint32_t>(parsed.width_px));
  output.set_height_px(static_cast<std::uint32_t>(parsed.height_px));
  return absl::OkStatus();
}

// Keeps what the file says of that kind of camera; another kind starts with its defaults.
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

absl::Status SetRenderer(const std::string& name, v1::Rendering& rendering) {
  v1::Renderer renderer = v1::RENDERER_UNSPECIFIED;
  const std::string value = absl::StrCat("RENDERER_", absl::AsciiStrToUpper(name));
  if (!v1::Renderer_Parse(value, &renderer) || renderer == v1::RENDERER_UNSPECIFIED) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--renderer is '", name, "'; it must be half_angle, light_volume, metaball or cumulus"));
  }
  rendering.set_renderer(renderer);
  return absl::OkStatus();
}

}  // namespace

void AddSceneOptions(CLI::App& command, SceneFlags& flags) {
  command.add_option("--scene", flags.file, "Scene as Protobuf JSON");
  command.add_option("--time", flags.time_index, "Which of the storm's times, from 0");
  command.add_option("--size", flags.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command.add_option("--camera", flags.camera, "orbit, spotter or top-down");
}

absl::StatusOr<v1::Scene> ReadScene(const SceneFlags& flags) {
  v1::Scene scene;
  if (!flags.file.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(scene, ReadFile(flags.file));
  }
  if (flags.time_index.has_value()) scene.set_time_index(*flags.time_index);
  if (flags.slices.has_value()) scene.mutable_rendering()->set_slices(*flags.slices);
  if (!flags.size.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(SetSize(flags.size, *scene.mutable_output()));
  }
  if (!flags.camera.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(SetCamera(flags.camera, *scene.mutable_camera()));
  }
  if (!flags.renderer.empty()) {
    THUNDERHEAD_RETURN_IF_ERROR(SetRenderer(flags.renderer, *scene.mutable_rendering()));
  }
  if (flags.max_error.has_value() && flags.max_milliseconds.has_value()) {
    return absl::InvalidArgumentError(
        "--max-error and --max-milliseconds exclude one another: leave one out");
  }
  if (flags.max_error.has_value()) scene.mutable_accuracy()->set_max_error(*flags.max_error);
  if (flags.max_milliseconds.has_value()) {
    scene.mutable_accuracy()->set_max_milliseconds(*flags.max_milliseconds);
  }
  return scene;
}

}  // namespace thunderhead::app
