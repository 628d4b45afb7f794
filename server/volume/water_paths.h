// Water paths of a medium's columns, kept where detail finer than the grid is drawn. Knows no scene
// and no GL.
#pragma once

#include <vector>

#include "volume/detail_control.h"
#include "volume/drawn_medium.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

// At how many points the medium is evaluated.
enum class WaterPathEffort {
  kQuick,  // while fields change
  kFull,
};

// Keeps the water paths of columns, each of the area of a cell, in two steps. First each channel of
// each column of `volume` is multiplied by what makes up for what detail takes from it on the mean.
// Then DetailTexel::column is set to what that leaves of all channels together, by which shaders
// multiply the medium at a place, wherever the displacement takes it from. That is linear between
// columns, and found for all of them together; so that channels keep their totals, each is
// multiplied by one more factor. Where no such factor is large enough, as billows leave next to
// nothing of a column, DetailTexel::amplitude is made weaker. `control` is DetailControlOf the
// volume. Returns the factors of `volume`, channels beside each other and then x and y: at most
// kMaxColumnFactor, and at least its inverse.
//
// So each channel's path of the whole storm is kept within 1 %, and that of all channels together
// in 19 of 20 columns; with kQuick in three of four
// (docs/decisions/0020-detail-of-the-model.md).
std::vector<float> KeepWaterPaths(const PlacedDetail& detail, DetailControl* control,
                                  ExtinctionVolume* volume,
                                  WaterPathEffort effort = WaterPathEffort::kFull);

// Multiplies columns by such factors, of the volume's own channels.
void ScaleColumns(const std::vector<float>& factors, ExtinctionVolume* volume);

inline constexpr float kMaxColumnFactor = 5.0F;

}  // namespace thunderhead::volume
