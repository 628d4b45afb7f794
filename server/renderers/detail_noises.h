// Noises on the device, each baked once for its octaves and seed and kept while in use or
// recent. Owns GL objects: use it on the context's thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "gl/objects.h"
#include "physics/detail_tile.h"

namespace thunderhead::renderers {

struct DetailNoise {
  physics::DetailTile tile;           // of a medium: the first level
  std::vector<gl::Texture3D> levels;  // repeat; each after the first is half as fine

  std::size_t Bytes() const;  // on the device
};

class DetailNoises {
 public:
  // Noise of a medium: physics::DetailTile, down to one texel.
  std::shared_ptr<const DetailNoise> Get(int octaves, std::uint32_t seed);
  // Noise of a surface: physics::TurbulenceTile, one level.
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

  std::vector<Entry> entries_;  // the one asked for last comes last
};

}  // namespace thunderhead::renderers
