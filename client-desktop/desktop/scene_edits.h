// Edits of a scene that concern several of its parts. Most of them follow the page
// (client-web/src/core/scene.ts). They do not depend on the window.
#pragma once

#include <string>

#include "thunderhead/v1/scene.pb.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::desktop {

// Shows another storm's last time. Clears what belongs to the old storm, so that the server chooses
// it anew: camera, fields and the sun's clock. Keeps light, rendering and picture.
void ChooseStorm(v1::Scene& scene, const std::string& storm_id);

// Replaces technique and settings by a preset, which also determines the source of the particle
// sizes. Drops an accuracy goal, for which the server would choose other settings.
void ChoosePreset(v1::Scene& scene, v1::Preset preset);

// Sets the source of all fields' particle sizes, and clears the source of each single field.
void ChooseParticleSizes(v1::Scene& scene, v1::ParticleSizes sizes);

// Sets the accuracy or the speed that the server must reach instead of a quality. The first value
// is the page's. LIMIT_NOT_SET removes the goal.
void ChooseGoal(v1::Scene& scene, v1::Accuracy::LimitCase goal);
// Returns true for presets that trade speed for accuracy. The other presets are the papers'
// settings.
bool IsQuality(v1::Preset preset);
// Returns the preset that equals the scene's rendering. This is needed because the server replaces
// a preset by its settings. Returns PRESET_UNSPECIFIED if there is none, or while an accuracy goal
// overrides it.
v1::Preset PresetOf(const v1::Scene& scene, const v1::GetServerInfoResponse& server);

}  // namespace thunderhead::desktop
