// Converts techniques between messages and values, with their defaults, presets and supported
// transports.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "scene/technique.h"
#include "scene/technique_info.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// Returns INVALID_ARGUMENT if the technique does not support the requested transport, or if it is
// an extension technique (`other`) that is not in `known`. The settings of extension techniques are
// not checked here, but when they draw.
absl::Status CheckRendering(const v1::Rendering& rendering,
                            const std::vector<scene::TechniqueInfo>& known);

// Replaces a preset by its technique. If no technique is given, uses that of the default preset.
// Then fills in the technique's defaults.
void FillTechniqueDefaults(v1::Rendering& rendering);

// Returns true if the rendering names a preset that reproduces a mode of the papers
// (accuracy::IsOfThePapers).
bool IsOfThePapers(const v1::Rendering& rendering);

// Converts a technique whose defaults are filled in.
scene::Technique ToTechnique(const v1::Rendering& rendering);

// These functions set every field of the technique's message.
void ToMessage(const scene::Technique& technique, v1::Rendering& message);
void ToMessage(const scene::TechniqueInfo& technique, v1::TechniqueDescription& message);

// Adds every preset with its technique.
void AddPresets(v1::GetServerInfoResponse& response);

}  // namespace thunderhead::service
