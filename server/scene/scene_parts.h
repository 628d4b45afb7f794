// The parts of a scene. One table says for each part which rendering stage a change of it
// invalidates, and whether the path-traced correction and the measured error depend on it.
#pragma once

#include <span>
#include <string_view>

#include "scene/scene.h"
#include "scene/stage.h"

namespace thunderhead::scene {

// A part of a scene: members whose changes have the same consequences.
struct ScenePart {
  std::string_view name;  // path of the members, such as "ground.cover"
  // Returns true if the part has the same value in both scenes.
  bool (*same)(const Scene& a, const Scene& b);
  Stage stage;  // the first stage that a change of the part can invalidate
  // True if light that was traced for a scene is no longer valid after a change of the part.
  bool light_correction;
  // True if an error that was measured for a scene is no longer valid after a change of the part.
  // The measured picture has neither turbulent detail nor lines on the ground (MeasuredScene in
  // accuracy/error_meters.h).
  bool measured_error;
  // For a part whose stage depends on the technique, a function that returns the first stage that
  // must rerun when `before` becomes `after`. Null if `stage` applies to every change.
  Stage (*first_dirty)(const Scene& before, const Scene& after) = nullptr;
};

// Returns the table. Each member of a scene belongs to exactly one part.
std::span<const ScenePart> SceneParts();

// Returns true if the scenes have the same values in all parts that have the property, which is
// &ScenePart::light_correction or &ScenePart::measured_error.
bool Agree(const Scene& a, const Scene& b, bool ScenePart::*property);

}  // namespace thunderhead::scene
