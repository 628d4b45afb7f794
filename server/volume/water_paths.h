// Water paths of a medium's columns, kept where detail finer than the grid is drawn. Knows no scene
// and no GL.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/drawn_medium.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

// For each channel of each column, channels beside each other and then x and y, the factor that
// makes up for what detail takes from it, so that its water path over the cell's area is about the
// one without detail: at most kMaxColumnFactor, and at least its inverse. `control` is
// DetailControlOf the volume.
//
// The storm's paths are kept within 1 %. Those of single columns are not: the displacement moves
// water to the columns beside it, and where billows leave nothing, no factor brings it back.
std::vector<float> WaterPathFactors(const std::vector<std::uint8_t>& control,
                                    const PlacedDetail& detail, const ExtinctionVolume& volume);

// Multiplies the columns by such factors, of the volume's own channels.
void ScaleColumns(const std::vector<float>& factors, ExtinctionVolume* volume);

// Both.
void KeepWaterPaths(const std::vector<std::uint8_t>& control, const PlacedDetail& detail,
                    ExtinctionVolume* volume);

inline constexpr float kMaxColumnFactor = 4.0F;

}  // namespace thunderhead::volume
