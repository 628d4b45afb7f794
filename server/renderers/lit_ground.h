// The brightness of the ground under a storm, as seen from the storm's cells. It is the ratio of
// the ground light that arrives at a place to the light of open ground (Illumination::from_ground).
// The code works with plain values on the CPU and does not use GL.
#pragma once

#include <cstddef>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// A lattice of texels over the ground. Beyond the lattice the ground counts as open.
struct GroundMap {
  glm::ivec2 size{0};
  glm::dvec2 low_m{0.0};  // corner of the first texel
  glm::dvec2 texel_m{1.0};
  std::vector<float> share;     // irradiance relative to that of open ground; x varies fastest
  std::vector<float> height_m;  // height of the ground above sea level
};

// The ratio of ground light at a place to the light of open ground. A level face at height h above
// uniformly bright ground gets the share r^2 / (r^2 + h^2) of its light from within the distance r.
// That distribution equals a sum of uniformly bright discs, which three discs approximate. The
// radii of the three discs, divided by h, are the 1/6, 1/2 and 5/6 quantiles of the radii in that
// sum. Each disc is looked up in the level of the map whose texels are as long as the disc's
// radius. The kernel of the interpolation between these texels then has the same variance as the
// disc.
class LitGround {
 public:
  // Creates open ground.
  LitGround() = default;
  explicit LitGround(GroundMap map);

  // Returns the ratio at `place_m`. It is 1 far above everything dark. `outward`, of a length of at
  // most 1, is the direction that a face looks to. A face that looks sideways sees ground farther
  // away on that side.
  float ShareAt(const glm::dvec3& place_m, const glm::vec3& outward = glm::vec3(0.0F)) const;

 private:
  // One resolution level of the darkness, which is 1 minus the share and 0 beyond the map. A border
  // of zeros makes look-ups beyond the map valid. The border is one texel wide at the low sides and
  // two texels wide at the high sides.
  struct Level {
    Level(const glm::ivec2& level_size, float level_scale);
    float& At(const glm::ivec2& texel) { return dark[Index(texel)]; }
    float At(const glm::ivec2& texel) const { return dark[Index(texel)]; }
    std::size_t Index(const glm::ivec2& texel) const {
      return static_cast<std::size_t>((texel.y + 1) * row + texel.x + 1);
    }

    glm::ivec2 size;
    float scale;  // number of this level's texels for each texel of the map
    int row;      // length of a row in texels, including the border
    std::vector<float> dark;
  };

  static Level HalfOf(const Level& fine);
  static float Dark(const Level& level, const glm::vec2& texel);
  // Returns the mean darkness within a disc whose radius is the texel size of level number `level`.
  float DarkWithin(const glm::vec2& texel, float level) const;
  float GroundHeight(const glm::vec2& texel) const;

  GroundMap map_;
  glm::dvec2 texels_per_m_{1.0};
  double mean_texels_per_m_ = 1.0;
  std::vector<Level> levels_;
};

}  // namespace thunderhead::renderers
