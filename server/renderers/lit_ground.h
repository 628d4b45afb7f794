// How bright the ground under a storm is, as the storm's cells see it: the share of the light of
// open ground (Illumination::from_ground) that comes up to a place. Plain values on the CPU; knows
// no GL.
#pragma once

#include <cstddef>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// A lattice of texels over the ground; beyond it the ground is open.
struct GroundMap {
  glm::ivec2 size{0};
  glm::dvec2 low_m{0.0};  // corner of the first texel
  glm::dvec2 texel_m{1.0};
  std::vector<float> share;     // of open ground's irradiance; x fastest
  std::vector<float> height_m;  // of the ground, above sea level
};

// A level face at the height h above ground of even brightness gets the share r^2 / (r^2 + h^2) of
// its light from within the distance r. That is a sum of evenly bright discs, three of which stand
// for all: their radii, in heights, are those below which a sixth, a half and five sixths of the
// discs are. Each is looked up in a level of the map whose texels are as long as its radius, which
// between them, as interpolated, have a disc's variance.
class LitGround {
 public:
  // Open ground.
  LitGround() = default;
  explicit LitGround(GroundMap map);

  // Of the light of open ground, what comes up to a place; 1 far above everything dark. A face that
  // looks aside, by `outward` of a length of at most 1, sees ground farther on that side.
  float ShareAt(const glm::dvec3& place_m, const glm::vec3& outward = glm::vec3(0.0F)) const;

 private:
  // Of 1 less the share, so that beyond the map there is none: it has a rim of zeros, one texel at
  // the low sides and two at the high ones, by which nothing is looked up outside.
  struct Level {
    Level(const glm::ivec2& level_size, float level_scale);
    float& At(const glm::ivec2& texel) { return dark[Index(texel)]; }
    float At(const glm::ivec2& texel) const { return dark[Index(texel)]; }
    std::size_t Index(const glm::ivec2& texel) const {
      return static_cast<std::size_t>((texel.y + 1) * row + texel.x + 1);
    }

    glm::ivec2 size;
    float scale;  // its texels in one of the map's
    int row;      // with the rim
    std::vector<float> dark;
  };

  static Level HalfOf(const Level& fine);
  static float Dark(const Level& level, const glm::vec2& texel);
  // Within a disc of the radius of a texel of level number `level`.
  float DarkWithin(const glm::vec2& texel, float level) const;
  float GroundHeight(const glm::vec2& texel) const;

  GroundMap map_;
  glm::dvec2 texels_per_m_{1.0};
  double mean_texels_per_m_ = 1.0;
  std::vector<Level> levels_;
};

}  // namespace thunderhead::renderers
