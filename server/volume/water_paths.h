// Corrects a medium so that drawn detail, which is finer than the grid, does not change the water
// paths of its columns. This code does not depend on scenes or GL.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/detail_control.h"
#include "volume/drawn_medium.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

// The effort of the computation. It decides at how many points the medium is evaluated.
enum class WaterPathEffort {
  kQuick,  // fewer points; used while fields change
  kFull,
};

// The factors by which KeepWaterPaths corrects the columns of a volume. The index of a column
// increases with x, then with y.
struct WaterPaths {
  // A column in which the amplitude of detail is multiplied by `share`.
  struct Weaker {
    std::uint32_t column = 0;
    float share = 1.0F;
  };

  std::vector<float> by_column;  // a factor for each column and channel, channel fastest
  std::vector<float> by_channel;
  std::vector<float> drawn;                   // the factor for each column that DetailTexel::column
                                              // stores
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
// channels together. A shader multiplies the medium at a place by the factor of that place, not of
// the displaced place from which the medium is read. Shaders interpolate the factors between
// columns, so all factors are computed together. In addition, one factor for each channel keeps the
// channel's total.
//
// Billows can remove nearly all medium from a column, so that no allowed factor is large enough.
// DetailTexel::amplitude of that column is then reduced. `control` must be the result of
// DetailControlOf for `volume`.
//
// Each channel's path of the whole storm is thus kept within 1 %. The path of all channels together
// is kept within 1 % in 99 of 100 columns. With more than 20 000 columns, the share is smaller.
// With kQuick, the path is kept in 6 of 10 columns, and in fewer for clouds of small puffs
// (docs/decisions/0020-detail-of-the-model.md).
WaterPaths KeepWaterPaths(const PlacedDetail& detail, DetailControl* control,
                          ExtinctionVolume* volume,
                          WaterPathEffort effort = WaterPathEffort::kFull);

// Repeats the changes of the KeepWaterPaths call that returned `paths`, on an equal volume and
// control.
void KeepWaterPathsAgain(const WaterPaths& paths, DetailControl* control, ExtinctionVolume* volume);

// Multiplies the texels of each column by `factors`, which are in the order of
// WaterPaths::by_column.
void ScaleColumns(const std::vector<float>& factors, ExtinctionVolume* volume);

inline constexpr float kMaxColumnFactor = 5.0F;

}  // namespace thunderhead::volume
