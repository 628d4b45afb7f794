// The model's control of detail finer than its grid, cell by cell: how far inside a cloud a cell
// is, and how strong billows or fibres are there, as shaders/physics/detail.glsl takes them. Knows
// no scene and no GL.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/extinction.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {

// Of a cell, as textures have it.
struct DetailTexel {
  static constexpr std::uint8_t kNoAmplitude = 128;
  static constexpr std::uint8_t kColumnOne = 128;

  std::uint8_t profile = 0;
  std::uint8_t amplitude = kNoAmplitude;  // billows from 129 to 255, fibres from 127 to 1
  std::uint8_t column = kColumnOne;       // detail_column_factor; volume/water_paths.h sets it
  std::uint8_t occupied = 0;              // 255 where the cell holds anything
};

using DetailControl = std::vector<DetailTexel>;  // of the extinction's grid, x fastest

// The profile is a binomial mean over 125 cells of their opacity along a cell against the largest
// of their neighbours'; empty cells have one, too, so that the surface between is rounded and not
// one of cells. The amplitude is that of turbulence (AirMotion) nearby, less where the medium is
// thin; billows where cloud water condenses (air rises, or its motion is not known) and where ice
// is in fast updraughts or strong turbulence (is opaque, if that is not known), fibres in other
// ice, neither in rain.
DetailControl DetailControlOf(const HydrometeorFields& fields,
                              const std::vector<ExtinctionTerm>& terms,
                              const ExtinctionVolume& volume);

}  // namespace thunderhead::volume
