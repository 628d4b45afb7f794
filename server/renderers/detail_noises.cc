#include "renderers/detail_noises.h"

#include <algorithm>

#include "physics/detail_tile.h"
#include "physics/turbulence.h"

namespace thunderhead::renderers {
namespace {

// Maximum number of noises that are kept, so that a user who tries many seeds does not exhaust
// memory.
constexpr std::size_t kMaxKept = 8;

gl::Texture3D Repeating(GLenum internal_format, int side, GLenum format,
                        const std::vector<std::uint8_t>& texels) {
  gl::Texture3D texture(internal_format, glm::ivec3(side), gl::Filter::kLinear, gl::Edge::kRepeat);
  texture.Upload(format, GL_UNSIGNED_BYTE, texels.data());
  return texture;
}

std::shared_ptr<const DetailNoise> BakeDetail(int octaves, std::uint32_t seed) {
  auto noise = std::make_shared<DetailNoise>();
  noise->tile = physics::MakeDetailTile(octaves, seed);
  std::vector<std::uint8_t> texels = noise->tile.texels;
  for (int side = physics::DetailTile::kSide; side >= 1; side /= 2) {
    noise->levels.push_back(Repeating(GL_RGBA8, side, GL_RGBA, texels));
    if (side > 1) texels = physics::CoarserLevel(texels, side);
  }
  return noise;
}

std::shared_ptr<const DetailNoise> BakeRoughness(int octaves, std::uint32_t seed) {
  const physics::TurbulenceTile tile = physics::MakeTurbulence(octaves, seed);
  auto noise = std::make_shared<DetailNoise>();
  noise->levels.push_back(Repeating(GL_R8, tile.side, GL_RED, tile.texels));
  return noise;
}

}  // namespace

std::size_t DetailNoise::Bytes() const {
  std::size_t bytes = 0;
  for (const gl::Texture3D& level : levels) bytes += level.Bytes();
  return bytes;
}

std::shared_ptr<const DetailNoise> DetailNoises::Get(int octaves, std::uint32_t seed) {
  return Find(Kind::kDetail, octaves, seed);
}

std::shared_ptr<const DetailNoise> DetailNoises::Roughness(int octaves, std::uint32_t seed) {
  return Find(Kind::kRoughness, octaves, seed);
}

std::shared_ptr<const DetailNoise> DetailNoises::Find(Kind kind, int octaves, std::uint32_t seed) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.kind == kind && entry.octaves == octaves && entry.seed == seed;
  });
  if (found != entries_.end()) {
    std::rotate(found, found + 1, entries_.end());
  } else {
    entries_.push_back(
        {kind, octaves, seed,
         kind == Kind::kDetail ? BakeDetail(octaves, seed) : BakeRoughness(octaves, seed)});
    if (entries_.size() > kMaxKept) entries_.erase(entries_.begin());
  }
  return entries_.back().noise;
}

}  // namespace thunderhead::renderers
