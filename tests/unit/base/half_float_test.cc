#include "base/half_float.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "glm/gtc/packing.hpp"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

TEST(HalfFromFloat, RoundsToTheNearestHalf) {
  for (std::uint32_t half = 0; half < 0x7BFF; ++half) {
    const float low = glm::unpackHalf1x16(static_cast<std::uint16_t>(half));
    const float high = glm::unpackHalf1x16(static_cast<std::uint16_t>(half + 1));
    ASSERT_EQ(HalfFromFloat(low), half);
    ASSERT_EQ(HalfFromFloat(low + 0.4F * (high - low)), half);
    ASSERT_EQ(HalfFromFloat(low + 0.6F * (high - low)), half + 1);
    ASSERT_EQ(HalfFromFloat(-low), half | 0x8000U);
    ASSERT_EQ(FloatFromHalf(static_cast<std::uint16_t>(half)), low);
  }
}

TEST(HalfFromFloat, WhatIsTooLargeIsTheLargest) {
  EXPECT_EQ(HalfFromFloat(1e6F), 0x7BFF);
  EXPECT_EQ(HalfFromFloat(-std::numeric_limits<float>::infinity()), 0xFBFF);
}

TEST(HalfFromFloat, WhatIsNoNumberStaysNone) {
  const std::uint16_t half = HalfFromFloat(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(std::isnan(glm::unpackHalf1x16(half)));
}

TEST(FloatFromHalf, InfinityIsBeyondTheLargest) { EXPECT_EQ(FloatFromHalf(0x7C00), 65536.0F); }

}  // namespace
}  // namespace thunderhead::base
