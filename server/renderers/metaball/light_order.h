// The order in which balls are splatted into a light buffer: the one nearest to the light first
// (Man, 4.1). Balls that cannot touch the same texels are independent and form a level. Processing
// level after level gives the same result as processing ball after ball. This code does not use GL.
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
  std::vector<std::uint32_t> starts;  // start of each level in `discs`, and the end

  std::size_t Levels() const { return starts.empty() ? 0 : starts.size() - 1; }
};

// `size` is the buffer's size in texels. Texels beyond the buffer count as on its edge.
LightOrder OrderFromLight(const std::vector<LightDisc>& discs, const glm::ivec2& size);

}  // namespace thunderhead::renderers
