// The renderer paths, modes and transports by name, for everything that measures all of them.
#pragma once

#include <array>
#include <string_view>

#include "scene/scene.h"

namespace thunderhead::measure {

template <typename Value>
struct Named {
  Value value;
  std::string_view name;  // as in proto/thunderhead/v1/scene.proto, in lower case
};

// Without the reference, which the others are measured against.
inline constexpr std::array<Named<scene::Renderer>, scene::kRendererCount - 1> kPaths = {{
    {scene::Renderer::kHalfAngle, "half_angle"},
    {scene::Renderer::kLightVolume, "light_volume"},
    {scene::Renderer::kMetaball, "metaball"},
    {scene::Renderer::kCumulus, "cumulus"},
}};

// Those that draw the fields as they are, cell by cell, so that their pictures have exact answers.
inline constexpr std::array<Named<scene::Renderer>, 2> kFieldPaths = {{kPaths[0], kPaths[1]}};

// In the order of Riley et al. 2003 (AMS), Table IV.
inline constexpr std::array<Named<scene::Mode>, 4> kModes = {{
    {scene::Mode::kUniformPhaseLowAlbedo, "uniform_phase_low_albedo"},
    {scene::Mode::kUniformPhaseTranslucent, "uniform_phase_translucent"},
    {scene::Mode::kPerFieldPhaseTranslucent, "per_field_phase_translucent"},
    {scene::Mode::kPerFieldPhaseDetailTranslucent, "per_field_phase_detail_translucent"},
}};

inline constexpr std::array<Named<scene::Transport>, 3> kTransports = {{
    {scene::Transport::kPaper, "paper"},
    {scene::Transport::kConsistent, "consistent"},
    {scene::Transport::kDiffusion, "diffusion"},
}};

}  // namespace thunderhead::measure
