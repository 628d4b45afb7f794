// Converts techniques between messages and values, with their defaults, presets and supported
// transports.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "scene/technique.h"
#include "scene/technique_info.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// INVALID_ARGUMENT names a transport that the technique does not support, or a technique that is
// not among `known`. Settings of techniques outside the schema are checked when they draw.
absl::Status CheckRendering(const v1::Rendering& rendering,
                            const std::vector<scene::TechniqueInfo>& known);

// Replaces a preset by its technique, an absent technique by the default preset's, and fills in the
// technique's defaults.
void FillTechniqueDefaults(v1::Rendering& rendering);

// True if a preset of the papers is asked for.
bool IsOfThePapers(const v1::Rendering& rendering);

// The value of a technique whose defaults are filled in.
scene::Technique ToTechnique(const v1::Rendering& rendering);

// Sets every field of the technique's message.
void ToMessage(const scene::Technique& technique, v1::Rendering& message);
void ToMessage(const scene::TechniqueInfo& technique, v1::TechniqueDescription& message);

// Adds every preset with its technique.
void AddPresets(v1::GetServerInfoResponse& response);

}  // namespace thunderhead::service
