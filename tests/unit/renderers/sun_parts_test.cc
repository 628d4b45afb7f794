#include "renderers/light_volume/sun_parts.h"

#include <cmath>

#include "glm/trigonometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::renderers {
namespace {

glm::dvec3 SunAt(double azimuth_deg) {
  const double azimuth = glm::radians(azimuth_deg);
  return {std::sin(azimuth), std::cos(azimuth), 0.0};
}

// Returns how many parts are computed for a sun.
std::size_t FoundAt(SunParts* parts, double azimuth_deg, bool in_turns = true) {
  const SunParts::Parts found = parts->Next(SunAt(azimuth_deg), in_turns);
  parts->Found(found, SunAt(azimuth_deg));
  return found.count();
}

TEST(SunParts, AllAreFoundFirstAndThenOneAfterTheOther) {
  SunParts parts;
  EXPECT_TRUE(parts.Next(SunAt(0.0), true).all());
  parts.Found(parts.Next(SunAt(0.0), true), SunAt(0.0));
  SunParts::Parts since;
  for (std::size_t i = 1; i <= SunParts::kCount; ++i) {
    const glm::dvec3 sun = SunAt(0.1 * static_cast<double>(i));
    const SunParts::Parts found = parts.Next(sun, true);
    EXPECT_EQ(found.count(), 1U);
    parts.Found(found, sun);
    since |= found;
  }
  EXPECT_TRUE(since.all());
}

TEST(SunParts, NoneStaysThatOfASunFarAway) {
  SunParts parts;
  FoundAt(&parts, 0.0);
  EXPECT_EQ(FoundAt(&parts, 0.9 * SunParts::kFarthest_deg), 1U);
  EXPECT_EQ(FoundAt(&parts, 1.1 * SunParts::kFarthest_deg), SunParts::kCount - 1);
  EXPECT_EQ(FoundAt(&parts, 90.0), SunParts::kCount);
}

TEST(SunParts, AllAreFoundWhereTurnsAreNotWantedAndOnceForgotten) {
  SunParts parts;
  FoundAt(&parts, 0.0);
  EXPECT_EQ(FoundAt(&parts, 0.1, false), SunParts::kCount);
  EXPECT_EQ(FoundAt(&parts, 0.2), 1U);
  parts.Forget();
  EXPECT_EQ(FoundAt(&parts, 0.3), SunParts::kCount);
}

TEST(SunParts, AllAreFoundForASunThatHasNotMoved) {
  SunParts parts;
  FoundAt(&parts, 0.0);
  EXPECT_EQ(FoundAt(&parts, 0.1), 1U);
  EXPECT_EQ(FoundAt(&parts, 0.1), SunParts::kCount);
}

}  // namespace
}  // namespace thunderhead::renderers
