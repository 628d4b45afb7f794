// Techniques between messages and values: defaults, presets and the transports that each accepts.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "scene/technique.h"
#include "session/frame_source.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// INVALID_ARGUMENT names a transport that the technique cannot show, or a technique that is none of
// `known`. Whether a technique takes its numbers is known when it draws.
absl::Status CheckRendering(const v1::Rendering& rendering,
                            const std::vector<session::TechniqueInfo>& known);

// Replaces a preset, or no technique at all, by the technique that it stands for, and fills in the
// technique's defaults.
void FillTechniqueDefaults(v1::Rendering& rendering);

// True if a preset of the papers is asked for.
bool IsOfThePapers(const v1::Rendering& rendering);

// The value of a technique whose defaults are filled in.
scene::Technique ToTechnique(const v1::Rendering& rendering);

// With every setting.
void ToMessage(const scene::Technique& technique, v1::Rendering& message);
void ToMessage(const session::TechniqueInfo& technique, v1::TechniqueDescription& message);

// Every preset with the technique that it stands for.
void AddPresets(v1::GetServerInfoResponse& response);

}  // namespace thunderhead::service
