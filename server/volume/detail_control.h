// The model's control of detail finer than its grid, cell by cell. It says how far inside a cloud a
// cell is, and how strong billows or fibres are there, in the form that shaders/physics/detail.glsl
// reads. This code does not depend on scenes or GL.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/extinction.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// The control of one cell, in the layout of a texel.
struct DetailTexel {
  static constexpr std::uint8_t kNoAmplitude = 128;
  static constexpr std::uint8_t kColumnOne = 128;

  std::uint8_t profile = 0;
  std::uint8_t amplitude = kNoAmplitude;  // billows from 129 to 255, fibres from 127 to 1
  std::uint8_t column = kColumnOne;       // detail_column_factor; volume/water_paths.h sets it
  std::uint8_t occupied = 0;              // 255 if the cell holds anything
};

using DetailControl = std::vector<DetailTexel>;  // on the extinction's grid, x fastest

// Computes the control of each cell.
//
// The profile is a binomial mean over 125 cells. It averages a cell's opacity relative to the
// largest opacity of its neighbours. Empty cells have a profile, too, so that the surface between
// them is rounded and does not follow the cells.
//
// The amplitude is that of the turbulence nearby (AirMotion), reduced where the medium is thin.
// Billows form where cloud water condenses: where air rises, or everywhere if its motion is
// unknown. They also form where ice is in fast updraughts or strong turbulence, or, if that is
// unknown, where ice is opaque. Other ice has fibres, and rain has neither.
DetailControl DetailControlOf(const HydrometeorFields& fields,
                              const std::vector<ExtinctionTerm>& terms,
                              const ExtinctionVolume& volume);

}  // namespace thunderhead::volume
