// Splits variables that hold both phases of water. WSM3 and Kessler have one variable for cloud
// water and cloud ice, and one for rain and snow.
#pragma once

#include <string>
#include <vector>

#include "physics/hydrometeors.h"

namespace thunderhead::storm_files {

enum class PhaseSplit {
  kNone,    // every variable holds one phase
  kSharp,   // all ice below 0 C (WSM3, Hong et al. 2004)
  kLinear,  // all ice below -40 C, no ice above 0 C, and a linear mixture between
};

// Returns how the scheme of this MP_PHYSICS splits its variables.
PhaseSplit PhaseSplitOf(int microphysics);

// Returns the frozen hydrometeor that shares the variable of cloud or rain: ice or snow.
physics::Hydrometeor FrozenPhaseOf(physics::Hydrometeor liquid);

// Returns the share of ice, 0 to 1. It is NaN where the temperature is.
float IceShare(PhaseSplit split, float temperature_K);

// Returns a sentence for users that says how `variables`, such as "QCLOUD and QRAIN", are split.
std::string Explained(PhaseSplit split, const std::string& variables);

}  // namespace thunderhead::storm_files
