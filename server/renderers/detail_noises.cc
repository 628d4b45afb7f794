#include "renderers/detail_noises.h"

#include <algorithm>

namespace thunderhead::renderers {
namespace {

// A seed that is tried and left costs memory only for a while.
constexpr std::size_t kMaxKept = 8;

std::shared_ptr<const DetailNoise> Bake(int octaves, std::uint32_t seed) {
  const physics::TurbulenceTile tile = physics::MakeTurbulence(octaves, seed);
  auto noise = std::make_shared<DetailNoise>();
  noise->texture =
      gl::Texture3D(GL_R8, glm::ivec3(tile.side), gl::Filter::kLinear, gl::Edge::kRepeat);
  noise->texture.Upload(GL_RED, GL_UNSIGNED_BYTE, tile.texels.data());
  noise->value_of_full = tile.value_of_full;
  return noise;
}

}  // namespace

std::shared_ptr<const DetailNoise> DetailNoises::Get(int octaves, std::uint32_t seed) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.octaves == octaves && entry.seed == seed;
  });
  if (found != entries_.end()) {
    std::rotate(found, found + 1, entries_.end());
  } else {
    entries_.push_back({octaves, seed, Bake(octaves, seed)});
    if (entries_.size() > kMaxKept) entries_.erase(entries_.begin());
  }
  return entries_.back().noise;
}

}  // namespace thunderhead::renderers
