// The scene that a command draws: a file of Protobuf JSON, and flags that override its values.
#pragma once

#include <optional>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::app {

// The names of the flag that chooses the technique. The second name is the earlier one, which is
// still accepted.
inline constexpr char kTechniqueFlag[] = "--technique,--renderer";

struct SceneFlags {
  std::string file;  // may be empty, like the other strings
  std::string view;  // another file, whose values override those of `file`
  std::optional<std::uint32_t> time_index;
  std::optional<std::uint32_t> slices;
  std::string size;       // WIDTHxHEIGHT
  std::string camera;     // orbit, spotter or top-down
  std::string technique;  // "half_angle" and so on
  std::string preset;     // "balanced" and so on; not together with `technique`
  std::optional<float> max_error;
  std::optional<float> max_milliseconds;  // not together with max_error
};

// Adds the options that all commands with a scene have: --scene, --size, --camera.
void AddViewOptions(CLI::App& command, SceneFlags& flags);
// Adds the same options and --time, for commands that show one time.
void AddSceneOptions(CLI::App& command, SceneFlags& flags);
// Adds the options of commands that draw the scene: --quality, --preset, --technique, --slices.
void AddTechniqueOptions(CLI::App& command, SceneFlags& flags);

// Returns the scene. INVALID_ARGUMENT names the file or flag, and what is wrong with it.
absl::StatusOr<v1::Scene> ReadScene(const SceneFlags& flags);

}  // namespace thunderhead::app
