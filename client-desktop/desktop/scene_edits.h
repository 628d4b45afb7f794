// Edits that change several parts of a scene at once. Most of them do the same as the web page's
// edits (client-web/src/core/scene.ts).
#pragma once

#include <string>

#include "thunderhead/v1/scene.pb.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::desktop {

// Shows another storm at its last time. Clears the camera, the fields and the sun's clock, because
// they belong to the old storm; the server chooses new values. Keeps light, rendering and picture
// settings.
void ChooseStorm(v1::Scene& scene, const std::string& storm_id);

// Replaces the rendering technique and its settings by a preset. The preset also determines where
// the particle sizes come from. Removes a goal (a required accuracy or speed), because the server
// would choose other settings to reach the goal.
void ChoosePreset(v1::Scene& scene, v1::Preset preset);

// Sets the source of the particle sizes for all fields, and clears the sources and radii that were
// set for single fields.
void ChooseParticleSizes(v1::Scene& scene, v1::ParticleSizes sizes);

// Sets a goal: an error or a time per frame that the server must keep by choosing the quality
// itself. The goal's first value is the same as on the web page. LIMIT_NOT_SET removes the goal.
void ChooseGoal(v1::Scene& scene, v1::Accuracy::LimitCase goal);
// Returns true for the quality presets, which trade speed for accuracy. The other presets reproduce
// the settings of papers.
bool IsQuality(v1::Preset preset);
// Returns the preset that the scene names, or else the preset whose settings equal the scene's
// rendering settings. A scene from the server names no preset, because the server replaces a preset
// by its settings. Returns PRESET_UNSPECIFIED if no preset matches, or if the scene has a goal.
v1::Preset PresetOf(const v1::Scene& scene, const v1::GetServerInfoResponse& server);

}  // namespace thunderhead::desktop
