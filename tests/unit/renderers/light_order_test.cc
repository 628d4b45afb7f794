#include "renderers/metaball/light_order.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "glm/common.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "renderers/metaball/wyvill.h"

namespace thunderhead::renderers {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Returns the level of each disc.
std::vector<std::size_t> LevelsOf(const LightOrder& order) {
  std::vector<std::size_t> levels(order.discs.size());
  for (std::size_t level = 0; level < order.Levels(); ++level) {
    for (std::uint32_t i = order.starts[level]; i < order.starts[level + 1]; ++i) {
      levels[order.discs[i]] = level;
    }
  }
  return levels;
}

TEST(LightOrder, TheNearestToTheLightComesFirst) {
  const LightOrder order =
      OrderFromLight({{{32, 32}, 4, 1.0}, {{33, 32}, 4, 3.0}, {{31, 32}, 4, 2.0}}, {64, 64});
  EXPECT_THAT(order.discs, ElementsAre(1, 2, 0));
  EXPECT_THAT(order.starts, ElementsAre(0, 1, 2, 3));
}

TEST(LightOrder, DiscsThatDoNotTouchShareALevel) {
  const LightOrder order = OrderFromLight(
      {{{8, 8}, 4, 1.0}, {{56, 8}, 4, 3.0}, {{8, 56}, 4, 2.0}, {{8, 9}, 4, 0.0}}, {64, 64});
  EXPECT_THAT(LevelsOf(order), ElementsAre(0, 0, 0, 1));
}

TEST(LightOrder, NoDiscsAreNoLevels) {
  EXPECT_EQ(OrderFromLight({}, {64, 64}).Levels(), 0U);
  EXPECT_THAT(OrderFromLight({}, {64, 64}).discs, IsEmpty());
}

TEST(LightOrder, DiscsBeyondTheBufferCountAsOnItsEdge) {
  const LightOrder order =
      OrderFromLight({{{-1e9, -1e9}, 1, 1.0}, {{0, 0}, 1e12, 2.0}, {{1e9, 70}, 3, 0.0}}, {64, 64});
  EXPECT_THAT(LevelsOf(order), ElementsAre(1, 0, 1));
}

// Any two discs that touch keep the order of their distances. The order of all others does not
// matter.
TEST(LightOrder, TouchingDiscsAreNeverInOneLevel) {
  std::vector<LightDisc> discs;
  unsigned state = 1;
  const auto random = [&state](double most) {
    state = state * 1664525U + 1013904223U;
    return most * (state >> 8U) / 16777216.0;
  };
  for (int i = 0; i < 300; ++i)
    discs.push_back({{random(256), random(256)}, random(20), random(1)});
  const std::vector<std::size_t> levels = LevelsOf(OrderFromLight(discs, {256, 256}));
  for (std::size_t i = 0; i < discs.size(); ++i) {
    for (std::size_t j = 0; j < discs.size(); ++j) {
      const glm::dvec2 apart = glm::abs(discs[i].middle - discs[j].middle);
      if (std::max(apart.x, apart.y) >= discs[i].reach + discs[j].reach) continue;
      if (discs[i].towards_light > discs[j].towards_light) {
        ASSERT_LT(levels[i], levels[j]);
      }
    }
  }
}

TEST(Wyvill, TheColumnIsTheFieldsIntegral) {
  for (const double u : {0.0, 0.3, 0.7, 0.95}) {
    const double s = 1.0 - u * u;
    for (const double to : {0.1, 0.5, 1.0}) {
      const double end = to * std::sqrt(s);
      double sum = 0.0;
      constexpr int kSteps = 4000;
      for (int i = 0; i < kSteps; ++i) {
        const double z = end * (i + 0.5) / kSteps;
        const double a = u * u + z * z;
        sum += 1.0 - 22.0 / 9 * a + 17.0 / 9 * a * a - 4.0 / 9 * a * a * a;
      }
      sum *= end / kSteps;
      EXPECT_NEAR(glsl::wyvill_column_to(static_cast<float>(s), static_cast<float>(end)), sum,
                  1e-6);
      if (to < 1.0) continue;
      EXPECT_NEAR(glsl::wyvill_column(static_cast<float>(s)), 2.0 * sum, 1e-6);
    }
  }
  EXPECT_EQ(glsl::wyvill_field(1.0F), 1.0F);
  EXPECT_EQ(glsl::wyvill_field(-0.5F), 0.0F);
  EXPECT_EQ(glsl::wyvill_column(-0.5F), 0.0F);
}

}  // namespace
}  // namespace thunderhead::renderers
