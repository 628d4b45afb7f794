// Computes the control data for detail finer than the model's grid. The data say for each cell how
// far inside a cloud it is and how strong its billows or fibres are. shaders/physics/detail.glsl
// reads them. This code does not depend on scenes or GL.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/extinction.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// The control data of one cell, in the layout of a texture's texel.
struct DetailTexel {
  static constexpr std::uint8_t kNoAmplitude = 128;
  static constexpr std::uint8_t kColumnOne = 128;

  std::uint8_t profile = 0;
  std::uint8_t amplitude = kNoAmplitude;  // 128 is none; billows grow from 129 to 255, fibres from
                                          // 127 down to 1
  std::uint8_t column = kColumnOne;       // argument of detail_column_factor; KeepWaterPaths sets
                                          // it
  std::uint8_t occupied = 0;              // 255 if the cell has any condensate, else 0
};

using DetailControl = std::vector<DetailTexel>;  // on the extinction's grid, x fastest

// Computes the control data of each cell of `volume`.
//
// The profile says how far inside a cloud a cell is. For each cell, its opacity is divided by the
// largest opacity of the cell and its neighbours. The profile is a binomial mean of these ratios
// over 5 x 5 x 5 cells. Empty cells near a cloud have a profile, too, so that the cloud's drawn
// surface is rounded and does not follow the faces of cells.
//
// The amplitude, the strength of billows or fibres, is that of the turbulence nearby (AirMotion),
// reduced where the medium is thin. Cloud water has billows where air rises, because it condenses
// there. If the air's motion is unknown, all cloud water has billows. Ice has billows in fast
// updraughts and in strong turbulence. If the turbulence is unknown, opaque ice has billows
// instead. Other ice has fibres, and rain has neither.
DetailControl DetailControlOf(const HydrometeorFields& fields,
                              const std::vector<ExtinctionTerm>& terms,
                              const ExtinctionVolume& volume);

}  // namespace thunderhead::volume
