// Water paths of a medium's columns, kept where detail finer than the grid is drawn: the medium is
// evaluated as shaders evaluate it (shaders/common/medium.glsl), with the noise that is drawn.
// Knows no scene and no GL.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/mat3x3.hpp"
#include "physics/detail_tile.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

// Detail as it is drawn in a volume's place.
struct PlacedDetail {
  struct Layer {
    const physics::DetailTile* tile = nullptr;
    double tile_m = 0.0;        // edge
    std::vector<float> shares;  // of each channel that the layer's noise multiplies
  };

  std::vector<Layer> layers;  // the first displaces the medium, all multiply it
  glm::dvec3 warp_m{0.0};     // the full displacement
  glm::dmat3 fibres{1.0};     // physics::FibresAlong
};

// Multiplies each channel of each column by what detail takes from it, so that its water path over
// the cell's area is about the one without detail; by at most kMaxColumnFactor, and at least its
// inverse. `control` is DetailControlOf the volume.
//
// The storm's paths are kept within 1 %. Those of single columns are not: the displacement moves
// water to the columns beside it, and where billows leave nothing, no factor brings it back.
void KeepWaterPaths(const std::vector<std::uint8_t>& control, const PlacedDetail& detail,
                    ExtinctionVolume* volume);

inline constexpr float kMaxColumnFactor = 4.0F;

}  // namespace thunderhead::volume
