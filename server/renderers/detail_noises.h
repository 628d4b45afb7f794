// Turbulence tiles on the device, each baked once for its octaves and seed and kept while in use or
// recent. Owns GL objects: use it on the context's thread.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "gl/objects.h"
#include "physics/turbulence.h"

namespace thunderhead::renderers {

struct DetailNoise {
  gl::Texture3D texture;  // repeats
  float value_of_full = 0.0F;
};

class DetailNoises {
 public:
  std::shared_ptr<const DetailNoise> Get(int octaves, std::uint32_t seed);

 private:
  struct Entry {
    int octaves;
    std::uint32_t seed;
    std::shared_ptr<const DetailNoise> noise;
  };

  std::vector<Entry> entries_;  // the one asked for last comes last
};

}  // namespace thunderhead::renderers
