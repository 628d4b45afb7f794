// The mean of a phase function over the sun's disc. Renderers and the path-traced reference treat
// the sun as a point. A table that holds the mean over the disc gives bows, halos and coronas the
// right sharpness.
#pragma once

#include "physics/phase_table.h"

namespace thunderhead::physics {

// Returns a table whose value at each angle is the mean of `point` over a uniformly bright disc of
// radius kSunRadius_rad around that angle.
PhaseTable UnderSunDisc(const PhaseTable& point);

}  // namespace thunderhead::physics
