#include "renderers/light_map.h"

#include "glm/geometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

glm::vec3 MapAt(const std::vector<glm::vec3>& map, const glm::vec3& n) {
  return map[0] + map[1] * n.y + map[2] * n.z + map[3] * n.x + map[4] * (n.x * n.y) +
         map[5] * (n.y * n.z) + map[6] * (3.0F * n.z * n.z - 1.0F) + map[7] * (n.x * n.z) +
         map[8] * (n.x * n.x - n.y * n.y);
}

const glm::vec3 kNormals[] = {{1.0F, 0.0F, 0.0F},   {0.0F, -1.0F, 0.0F}, {0.0F, 0.0F, 1.0F},
                              {0.0F, 0.0F, -1.0F},  {0.6F, 0.8F, 0.0F},  {-0.6F, 0.0F, 0.8F},
                              {0.48F, 0.64F, -0.6F}};

TEST(LightMap, EvenLightStaysEven) {
  const auto map = LightMapOf([](const glm::vec3&) { return glm::vec3(1.0F, 2.0F, 3.0F); });
  for (const glm::vec3& n : kNormals) {
    EXPECT_LT(glm::length(MapAt(map, n) - glm::vec3(1.0F, 2.0F, 3.0F)), 1e-3F);
  }
}

// A vertical face sees half of a bright sky, an upward face sees all of it, and a downward face
// sees nothing of it.
TEST(LightMap, ASkyAloneLightsByHowMuchOfItIsSeen) {
  const auto map =
      LightMapOf([](const glm::vec3& from) { return glm::vec3(from.z > 0.0F ? 1.0F : 0.0F); });
  for (const glm::vec3& n : kNormals) EXPECT_NEAR(MapAt(map, n).r, 0.5F + 0.5F * n.z, 1e-3F);
}

// A small lamp lights a surface in proportion to the cosine of the angle between the lamp and the
// surface's normal. The harmonics approximate this with an error of at most about 10 % of the
// brightest value.
TEST(LightMap, ALampFollowsTheCosine) {
  const glm::vec3 lamp = glm::normalize(glm::vec3(0.3F, -0.5F, 0.7F));
  const auto map = LightMapOf(
      [&](const glm::vec3& from) { return glm::vec3(glm::dot(from, lamp) > 0.95F ? 1.0F : 0.0F); });
  const float brightest = MapAt(map, lamp).r;
  for (const glm::vec3& n : kNormals) {
    EXPECT_NEAR(MapAt(map, n).r / brightest, std::max(glm::dot(n, lamp), 0.0F), 0.12F);
  }
}

}  // namespace
}  // namespace thunderhead::renderers
