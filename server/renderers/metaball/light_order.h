// In which order balls are splatted into a light buffer: the one nearest to the light first (Man,
// 4.1). Balls that cannot touch the same texels need not wait for one another: they form a level,
// and levels in turn give what one ball after the other would give. Knows no GL.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/vec2.hpp"

namespace thunderhead::renderers {

// A ball in the light buffer.
struct LightDisc {
  glm::dvec2 middle{0.0};    // in texels
  double reach = 1.0;        // in texels
  double towards_light = 0;  // larger is nearer to the light
};

struct LightOrder {
  std::vector<std::uint32_t> discs;   // level by level
  std::vector<std::uint32_t> starts;  // of each level in `discs`, and the end

  std::size_t Levels() const { return starts.empty() ? 0 : starts.size() - 1; }
};

// `size` is the buffer's in texels; what is beyond counts as on its edge.
LightOrder OrderFromLight(const std::vector<LightDisc>& discs, const glm::ivec2& size);

}  // namespace thunderhead::renderers
