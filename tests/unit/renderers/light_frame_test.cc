#include "renderers/light_frame.h"

#include <cmath>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"
#include "scene/view.h"

namespace thunderhead::renderers {
namespace {

TEST(LightFrame, CoversTheShadow) {
  const LocalBox box{{500.0, 400.0, 100.0}};
  const LightFrame frame = LightFrameOf(box, scene::Direction(123, 33));
  EXPECT_NEAR(glm::dot(frame.right, frame.up), 0.0, 1e-12);
  EXPECT_NEAR(glm::dot(frame.right, frame.towards_sun), 0.0, 1e-12);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 sign((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
    EXPECT_LE(std::abs(glm::dot(sign * box.half_m, frame.right)), frame.half_extent_m.x + 1e-9);
    EXPECT_LE(std::abs(glm::dot(sign * box.half_m, frame.up)), frame.half_extent_m.y + 1e-9);
  }
}

}  // namespace
}  // namespace thunderhead::renderers
