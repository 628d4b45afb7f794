// How bright the ground under a storm is, as seen from the storm's cells. It is the share of the
// light of open ground (Illumination::from_ground) that arrives at a place. The code works with
// plain values on the CPU and does not use GL.
#pragma once

#include <cstddef>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"

namespace thunderhead::renderers {

// A lattice of texels over the ground. Beyond it the ground is open.
struct GroundMap {
  glm::ivec2 size{0};
  glm::dvec2 low_m{0.0};  // corner of the first texel
  glm::dvec2 texel_m{1.0};
  std::vector<float> share;     // of open ground's irradiance; x varies fastest
  std::vector<float> height_m;  // of the ground, above sea level
};

// The share of ground light at a place. A level face at height h above uniformly bright ground gets
// the share r^2 / (r^2 + h^2) of its light from within the distance r. That equals a sum of
// uniformly bright discs, which three discs represent. Their radii, in heights, are those below
// which a sixth, a half and five sixths of the discs lie. Each disc is looked up in the level of
// the map whose texels are as long as the disc's radius. Interpolation between these texels has the
// variance of a disc.
class LitGround {
 public:
  // Creates open ground.
  LitGround() = default;
  explicit LitGround(GroundMap map);

  // Returns the share of the light of open ground that arrives at a place. It is 1 far above
  // everything dark. A face that looks sideways sees ground farther on that side. `outward`, of a
  // length of at most 1, gives its direction.
  float ShareAt(const glm::dvec3& place_m, const glm::vec3& outward = glm::vec3(0.0F)) const;

 private:
  // One level of 1 minus the share, which is 0 beyond the map. A border of zeros, one texel at the
  // low sides and two at the high ones, prevents look-ups outside.
  struct Level {
    Level(const glm::ivec2& level_size, float level_scale);
    float& At(const glm::ivec2& texel) { return dark[Index(texel)]; }
    float At(const glm::ivec2& texel) const { return dark[Index(texel)]; }
    std::size_t Index(const glm::ivec2& texel) const {
      return static_cast<std::size_t>((texel.y + 1) * row + texel.x + 1);
    }

    glm::ivec2 size;
    float scale;  // its texels per texel of the map
    int row;      // including the border
    std::vector<float> dark;
  };

  static Level HalfOf(const Level& fine);
  static float Dark(const Level& level, const glm::vec2& texel);
  // Returns the mean darkness within a disc whose radius is a texel of level number `level`.
  float DarkWithin(const glm::vec2& texel, float level) const;
  float GroundHeight(const glm::vec2& texel) const;

  GroundMap map_;
  glm::dvec2 texels_per_m_{1.0};
  double mean_texels_per_m_ = 1.0;
  std::vector<Level> levels_;
};

}  // namespace thunderhead::renderers
