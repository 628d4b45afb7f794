// Water paths of a medium's columns, kept where detail finer than the grid is drawn. Knows no scene
// and no GL.
#pragma once

#include <cstdint>
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

// By what the columns of a volume keep their water paths. Columns are by x, then y.
struct WaterPaths {
  // A column in which detail's amplitude is multiplied by a share.
  struct Weaker {
    std::uint32_t column = 0;
    float share = 1.0F;
  };

  std::vector<float> by_column;  // factors of the volume's channels, which are beside each other
  std::vector<float> by_channel;
  std::vector<float> drawn;                   // factors of DetailTexel::column
  std::vector<std::vector<Weaker>> weakened;  // one time after the other

  // Factors of the volume, as `by_column`: at most kMaxColumnFactor, and at least its inverse.
  std::vector<float> OfVolume() const;
};

// Keeps the water paths of columns, each of the area of a cell, in two steps. First each channel of
// each column of `volume` is multiplied by what makes up for what detail takes from it on the mean.
// Then DetailTexel::column is set to what that leaves of all channels together, by which shaders
// multiply the medium at a place, wherever the displacement takes it from. That is linear between
// columns, and found for all of them together; so that channels keep their totals, each is
// multiplied by one more factor. Where no such factor is large enough, as billows leave next to
// nothing of a column, DetailTexel::amplitude is made weaker. `control` is DetailControlOf the
// volume.
//
// So each channel's path of the whole storm is kept within 1 %, and that of all channels together
// in 99 of 100 columns, on domains of more than 20 000 columns in fewer; with kQuick in 6 of 10, in
// clouds of small puffs in fewer (docs/decisions/0020-detail-of-the-model.md).
WaterPaths KeepWaterPaths(const PlacedDetail& detail, DetailControl* control,
                          ExtinctionVolume* volume,
                          WaterPathEffort effort = WaterPathEffort::kFull);

// Does to the same volume and control what the call that returned `paths` did.
void KeepWaterPathsAgain(const WaterPaths& paths, DetailControl* control, ExtinctionVolume* volume);

// Multiplies columns by such factors, of the volume's own channels.
void ScaleColumns(const std::vector<float>& factors, ExtinctionVolume* volume);

inline constexpr float kMaxColumnFactor = 5.0F;

}  // namespace thunderhead::volume
