// Draws phase tables as curves over the scattering angle.
#pragma once

#include <string>
#include <vector>

#include "physics/phase_table.h"

namespace thunderhead::physics {

// Returns an SVG with a panel for each table. The three channels are in colour on a logarithmic
// scale.
std::string CurvesSvg(const std::vector<PhaseTable>& tables);

}  // namespace thunderhead::physics
