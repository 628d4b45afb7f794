// Draws phase tables as curves over the scattering angle.
#pragma once

#include <string>
#include <vector>

#include "physics/phase_table.h"

namespace thunderhead::physics {

// Returns an SVG with a panel for each table. Each panel shows the three colour channels in their
// colours on a logarithmic scale.
std::string CurvesSvg(const std::vector<PhaseTable>& tables);

}  // namespace thunderhead::physics
