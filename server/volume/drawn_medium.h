// A medium with detail, evaluated at any place like in the shaders (shaders/common/medium.glsl).
// Unlike there, no noise is left out because it is finer than a pixel. This code does not depend on
// scenes or GL.
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

// The detail of a volume at the volume's place in the world.
struct PlacedDetail {
  struct Layer {
    const physics::DetailTile* tile = nullptr;
    double tile_m = 0.0;        // edge
    std::vector<float> shares;  // for each channel, the share that the layer's noise multiplies
    glm::dvec2 drift_m{0.0};    // displacement of the noise from its place in the world
  };

  std::vector<Layer> layers;  // the first displaces the medium, all multiply it
  glm::dvec3 warp_m{0.0};     // displacement at full amplitude
  glm::dmat3 fibres{1.0};     // physics::FibresAlong
};

class DrawnMedium {
 public:
  // The volume's texel values by channel. Channels that it does not have are 0.
  using Channels = std::array<float, kMaxChannels>;

  // `control` is the result of DetailControlOf for the volume. All arguments except `detail` must
  // outlive this object.
  DrawnMedium(const DetailControl& control, const PlacedDetail& detail,
              const ExtinctionVolume& volume);

  // Returns the medium at a place, in cells from the volume's low corner. Beyond the grid the
  // outermost cells continue.
  Channels At(const glm::vec3& in_cells) const;

  // Evaluates eight places at once, in less than half of the time.
  struct Places {
    std::array<float, base::kLanes> x, y, z;
  };
  using ChannelsAt = std::array<std::array<float, base::kLanes>, kMaxChannels>;
  void At(const Places& in_cells, ChannelsAt* values) const;

 private:
  static constexpr std::size_t kCorners = 8;

  struct Layer {
    const std::uint8_t* texels;
    glm::vec3 corner;  // the volume's corner, in tiles
    glm::vec3 cell;    // a cell's size, in tiles
    Channels shares;
  };

  template <typename Floats>
  struct Lanes;

  void AtWithAvx2(const Places& in_cells, ChannelsAt* values) const;

  const DetailControl& control_;
  const ExtinctionVolume& volume_;
  std::array<std::size_t, kCorners> corners_;  // offsets of a cell's corners from the lowest one
  glm::vec3 warp_;                             // displacement in cells
  glm::mat3 fibres_;
  std::vector<Layer> layers_;
};

}  // namespace thunderhead::volume
