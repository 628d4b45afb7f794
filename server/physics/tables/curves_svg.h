// Draws phase tables as curves over the scattering angle.
#pragma once

#include <string>
#include <vector>

#include "physics/phase_table.h"

namespace thunderhead::physics {

// A panel for each table, its three channels in colour on a logarithmic scale.
std::string CurvesSvg(const std::vector<PhaseTable>& tables);

}  // namespace thunderhead::physics
