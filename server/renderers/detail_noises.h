// Noise textures on the device. Each noise is computed once for its octaves and seed, and kept
// while it is in use or was recently used. The class owns GL objects, so use it on the context's
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "gl/objects.h"
#include "physics/detail_tile.h"

namespace thunderhead::renderers {

struct DetailNoise {
  physics::DetailTile tile;  // the noise of the first level; set only for the noise of a medium
  // Repeating textures. Each level has half the resolution of the level before.
  std::vector<gl::Texture3D> levels;

  std::size_t Bytes() const;  // bytes on the device
};

class DetailNoises {
 public:
  // Returns the noise of a medium: physics::DetailTile, with levels down to one texel.
  std::shared_ptr<const DetailNoise> Get(int octaves, std::uint32_t seed);
  // Returns the noise of a surface: physics::TurbulenceTile, with one level.
  std::shared_ptr<const DetailNoise> Roughness(int octaves, std::uint32_t seed);

 private:
  enum class Kind { kDetail, kRoughness };
  struct Entry {
    Kind kind;
    int octaves;
    std::uint32_t seed;
    std::shared_ptr<const DetailNoise> noise;
  };

  std::shared_ptr<const DetailNoise> Find(Kind kind, int octaves, std::uint32_t seed);

  std::vector<Entry> entries_;  // the most recently requested is last
};

}  // namespace thunderhead::renderers
