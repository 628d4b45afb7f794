// The flag --phase.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "reference/sampled_phase.h"

namespace thunderhead::app {

inline constexpr char kPhaseFlagHelp[] =
    "Phase function: hg:G (Henyey-Greenstein), cs:G (Cornette-Shanks), rayleigh, or table:NAME";

// Parses a phase function such as "hg:0.85", "cs:0.85", "rayleigh" or "table:cloud_re10".
// INVALID_ARGUMENT lists the formats.
absl::StatusOr<std::shared_ptr<const reference::SampledPhase>> ParsePhase(const std::string& text);

}  // namespace thunderhead::app
