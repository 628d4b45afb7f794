// Keeps the water paths of a medium's columns where detail finer than the grid is drawn. This code
// does not depend on scenes or GL.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/detail_control.h"
#include "volume/drawn_medium.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

// The effort, which decides at how many points the medium is evaluated.
enum class WaterPathEffort {
  kQuick,  // used while fields change
  kFull,
};

// The factors with which the columns of a volume keep their water paths. Columns are by x, then y.
struct WaterPaths {
  // A column in which detail's amplitude is multiplied by a share.
  struct Weaker {
    std::uint32_t column = 0;
    float share = 1.0F;
  };

  std::vector<float> by_column;  // factors of the volume's channels; those of a column are adjacent
  std::vector<float> by_channel;
  std::vector<float> drawn;                   // factors of DetailTexel::column
  std::vector<std::vector<Weaker>> weakened;  // one list for each round of weakening

  // Returns the volume's factors in the order of `by_column`, from 1 / kMaxColumnFactor to
  // kMaxColumnFactor.
  std::vector<float> OfVolume() const;
};

// Corrects the medium so that drawn detail does not change the water paths of columns, each of the
// area of a cell. It works in two steps.
//
// First, it multiplies each channel of each column of `volume` by a factor. The factor makes up for
// the mean loss caused by detail.
//
// Second, it sets DetailTexel::column to a factor that makes up for the loss that remains for all
// channels together. Shaders multiply the medium at a place by it, wherever the displacement takes
// the medium from. These factors are linear between columns, so they are found for all columns
// together. One more factor for each channel keeps the channel's total.
//
// Billows can remove nearly everything from a column, so that no such factor is large enough.
// DetailTexel::amplitude is then weakened. `control` must be DetailControlOf the volume.
//
// Each channel's path of the whole storm is thus kept within 1 %. The path of all channels together
// is kept within 1 % in 99 of 100 columns. Domains of more than 20 000 columns keep it in fewer.
// With kQuick it is kept in 6 of 10 columns, and in fewer in clouds of small puffs
// (docs/decisions/0020-detail-of-the-model.md).
WaterPaths KeepWaterPaths(const PlacedDetail& detail, DetailControl* control,
                          ExtinctionVolume* volume,
                          WaterPathEffort effort = WaterPathEffort::kFull);

// Does to the same volume and control what the call that returned `paths` did.
void KeepWaterPathsAgain(const WaterPaths& paths, DetailControl* control, ExtinctionVolume* volume);

// Multiplies columns by such factors, one for each of the volume's channels.
void ScaleColumns(const std::vector<float>& factors, ExtinctionVolume* volume);

inline constexpr float kMaxColumnFactor = 5.0F;

}  // namespace thunderhead::volume
