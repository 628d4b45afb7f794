// The order in which balls are splatted into a light buffer, with the ball nearest to the light
// first (P. Man, "Generating and Real-Time Rendering of Clouds", section 4.1). Balls that cannot
// touch the same texels are independent of each other and form a level. Processing level after
// level gives the same result as processing ball after ball. This code does not use GL.
#pragma once

#include <cstdint>
#include <vector>

#include "glm/vec2.hpp"

namespace thunderhead::renderers {

// The disc that a ball covers in the light buffer.
struct LightDisc {
  glm::dvec2 middle{0.0};    // centre in texels
  double reach = 1.0;        // radius in texels
  double towards_light = 0;  // position along the light's direction; larger is nearer to the light
};

struct LightOrder {
  std::vector<std::uint32_t> discs;  // indices of the balls, level by level
  // Index in `discs` at which each level starts, followed by the size of `discs`.
  std::vector<std::uint32_t> starts;

  std::size_t Levels() const { return starts.empty() ? 0 : starts.size() - 1; }
};

// Returns the order of `discs`. `size` is the buffer's size in texels. Parts of a disc beyond the
// buffer count as texels on the buffer's edge.
LightOrder OrderFromLight(const std::vector<LightDisc>& discs, const glm::ivec2& size);

}  // namespace thunderhead::renderers
