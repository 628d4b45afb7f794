// A scene as commands are given it: a file of Protobuf JSON, and flags that override it.
#pragma once

#include <optional>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::app {

struct SceneFlags {
  std::string file;  // may be empty
  std::optional<std::uint32_t> time_index;
  std::optional<std::uint32_t> slices;
  std::string size;       // WxH, may be empty
  std::string camera;     // orbit, spotter or top-down; may be empty
  std::string technique;  // "half_angle" and so on; may be empty
  std::string preset;     // "balanced" and so on; may be empty, and is if `technique` is not
  std::optional<float> max_error;
  std::optional<float> max_milliseconds;  // at most one of the two
};

// The options of every command that takes a scene: --scene, --time, --size, --camera.
void AddSceneOptions(CLI::App& command, SceneFlags& flags);
// Those of commands that draw it: --quality, --preset, --renderer, --slices.
void AddTechniqueOptions(CLI::App& command, SceneFlags& flags);

// INVALID_ARGUMENT names the file or flag and what is wrong with it.
absl::StatusOr<v1::Scene> ReadScene(const SceneFlags& flags);

}  // namespace thunderhead::app
