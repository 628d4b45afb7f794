// Evaluates a medium with its detail at any place, like the shaders do
// (shaders/common/medium.glsl). The shaders leave out noise that is finer than a pixel; this code
// does not. This code does not depend on scenes or GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/simd.h"
#include "glm/mat3x3.hpp"
#include "glm/vec3.hpp"
#include "physics/detail_tile.h"
#include "volume/detail_control.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

// The parameters of the detail that is added to a volume, in world coordinates.
struct PlacedDetail {
  struct Layer {
    const physics::DetailTile* tile = nullptr;
    double tile_m = 0.0;        // length of the tile's edge in the world
    std::vector<float> shares;  // for each channel, the share of the medium that the noise affects
    glm::dvec2 drift_m{0.0};    // horizontal shift of the noise from its original position
  };

  std::vector<Layer> layers;  // the first layer displaces the medium; every layer's noise
                              // multiplies it
  glm::dvec3 warp_m{0.0};     // largest displacement along each axis
  glm::dmat3 fibres{1.0};     // result of physics::FibresAlong: rotates and stretches noise along
                              // fibres
};

class DrawnMedium {
 public:
  // The texel values of the volume's channels. Channels that the volume does not have are 0.
  using Channels = std::array<float, kMaxChannels>;

  // `control` is the result of DetailControlOf for the volume. `control`, `volume` and the tiles of
  // `detail` must outlive this object.
  DrawnMedium(const DetailControl& control, const PlacedDetail& detail,
              const ExtinctionVolume& volume);

  // Returns the medium at a place. The place is in cells, relative to the volume's low corner.
  // Beyond the grid, the values of the outermost cells are used.
  Channels At(const glm::vec3& in_cells) const;

  // Evaluates eight places in one call, which takes less than half as long as eight calls.
  struct Places {
    std::array<float, base::kSimdWidth> x, y, z;
  };
  using ChannelsAt = std::array<std::array<float, base::kSimdWidth>, kMaxChannels>;
  void At(const Places& in_cells, ChannelsAt* values) const;

 private:
  static constexpr std::size_t kCorners = 8;

  struct Layer {
    const std::uint8_t* texels;
    glm::vec3 corner;  // position of the volume's low corner, in units of the tile's edge
    glm::vec3 cell;    // size of a cell, in units of the tile's edge
    Channels shares;
  };

  template <typename Floats>
  struct Simd;

  void AtWithAvx2(const Places& in_cells, ChannelsAt* values) const;

  const DetailControl& control_;
  const ExtinctionVolume& volume_;
  std::array<std::size_t, kCorners> corners_;  // offsets of a cell's corners from the lowest one
  glm::vec3 warp_;                             // PlacedDetail::warp_m, in cells
  glm::mat3 fibres_;
  std::vector<Layer> layers_;
};

}  // namespace thunderhead::volume
