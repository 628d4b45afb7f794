// A phase function's mean over the sun's disc. Renderers and reference take the sun for a point;
// tables that hold the mean over its disc give them bows, halos and coronas of the right sharpness.
#pragma once

#include "physics/phase_table.h"

namespace thunderhead::physics {

// The table whose value at each angle is the mean of `point`'s over an evenly bright disc of radius
// kSunRadius_rad, seen around that angle.
PhaseTable UnderSunDisc(const PhaseTable& point);

}  // namespace thunderhead::physics
