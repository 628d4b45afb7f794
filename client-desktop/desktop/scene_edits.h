// Edits of a scene that concern several of its parts, as the page makes most of them
// (client-web/src/core/scene.ts). They know no window.
#pragma once

#include <string>

#include "thunderhead/v1/scene.pb.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::desktop {

// Shows another storm's last time. What belongs to the old one goes, so that the server chooses it
// anew: camera, fields and the sun's clock. Light, rendering and picture stay.
void ChooseStorm(v1::Scene& scene, const std::string& storm_id);

// Replaces technique and settings by a preset, which also stands for where particles' sizes come
// from. Drops an accuracy goal, for which the server would choose other settings.
void ChoosePreset(v1::Scene& scene, v1::Preset preset);

// Where the sizes of all fields' particles come from: the fields no longer say so themselves.
void ChooseParticleSizes(v1::Scene& scene, v1::ParticleSizes sizes);

// The accuracy or the speed that the server is to reach in place of a quality, at first the page's;
// LIMIT_NOT_SET: none.
void ChooseGoal(v1::Scene& scene, v1::Accuracy::LimitCase goal);
// True for those that trade speed for accuracy; the other presets are the papers'.
bool IsQuality(v1::Preset preset);
// The preset that the scene's rendering is, which the server replaces by what it stands for;
// PRESET_UNSPECIFIED for none, or while an accuracy goal overrides it.
v1::Preset PresetOf(const v1::Scene& scene, const v1::GetServerInfoResponse& server);

}  // namespace thunderhead::desktop
