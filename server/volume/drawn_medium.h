// A medium with detail at any place, evaluated as shaders evaluate it (shaders/common/medium.glsl)
// where nothing of the noise is left out for being finer than a pixel. Knows no scene and no GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/lanes.h"
#include "glm/mat3x3.hpp"
#include "glm/vec3.hpp"
#include "physics/detail_tile.h"
#include "volume/detail_control.h"
#include "volume/extinction.h"

namespace thunderhead::volume {

// Detail as it is drawn in a volume's place.
struct PlacedDetail {
  struct Layer {
    const physics::DetailTile* tile = nullptr;
    double tile_m = 0.0;        // edge
    std::vector<float> shares;  // of each channel that the layer's noise multiplies
    glm::dvec2 drift_m{0.0};    // of the noise from its place in the world
  };

  std::vector<Layer> layers;  // the first displaces the medium, all multiply it
  glm::dvec3 warp_m{0.0};     // the full displacement
  glm::dmat3 fibres{1.0};     // physics::FibresAlong
};

class DrawnMedium {
 public:
  // By channel: texel values of the volume, those that it does not have being 0.
  using Channels = std::array<float, kMaxChannels>;

  // `control` is DetailControlOf the volume. All but `detail` must outlive it.
  DrawnMedium(const DetailControl& control, const PlacedDetail& detail,
              const ExtinctionVolume& volume);

  // `in_cells` is a place in cells from the volume's low corner. Beyond the grid it is that of the
  // outermost cells.
  Channels At(const glm::vec3& in_cells) const;

  // At eight places, in less than half of the time.
  struct Places {
    std::array<float, base::kLanes> x, y, z;
  };
  using ChannelsAt = std::array<std::array<float, base::kLanes>, kMaxChannels>;
  void At(const Places& in_cells, ChannelsAt* values) const;

 private:
  static constexpr std::size_t kCorners = 8;

  struct Layer {
    const std::uint8_t* texels;
    glm::vec3 corner;  // of the volume, in tiles
    glm::vec3 cell;    // in tiles
    Channels shares;
  };

  template <typename Floats>
  struct Lanes;

  void AtWithAvx2(const Places& in_cells, ChannelsAt* values) const;

  const DetailControl& control_;
  const ExtinctionVolume& volume_;
  std::array<std::size_t, kCorners> corners_;  // from the lowest
  glm::vec3 warp_;                             // in cells
  glm::mat3 fibres_;
  std::vector<Layer> layers_;
};

}  // namespace thunderhead::volume
