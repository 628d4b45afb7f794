#include "physics/field_pattern.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"
#include "physics/counter_random.h"

namespace thunderhead::physics {
namespace {

constexpr glm::vec3 kPlain(1.0F, 0.93F, 0.78F);  // relative red, green and blue of plain ground
constexpr float kMap_m = glsl::kFieldMapCells * 402.336F;

float Luminance(const glm::vec3& rgb) {
  return glm::dot(rgb, glm::vec3(0.2126F, 0.7152F, 0.0722F));
}

glm::vec2 Between(CounterRandom& random, const glm::vec2& low_m, const glm::vec2& size_m) {
  const auto x = static_cast<float>(random.Next());
  return low_m + glm::vec2(x, static_cast<float>(random.Next())) * size_m;
}

// Evaluates the pattern at points all over the map.
TEST(FieldPattern, MeanLuminanceIsThatOfPlainGround) {
  CounterRandom random(1, 2);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kPoints = 400'000;
  for (int i = 0; i < kPoints; ++i) {
    const glm::vec2 place_m = Between(random, glm::vec2(-1e5F), glm::vec2(kMap_m));
    const glm::vec3 factor = FieldPattern::Plains().Reflectance(place_m, glm::vec2(0.0F), 1.0F);
    const double luminance = Luminance(kPlain * factor) / Luminance(kPlain);
    sum += luminance;
    squares += luminance * luminance;
  }
  const double mean = sum / kPoints;
  const double deviation = std::sqrt(squares / kPoints - mean * mean);
  EXPECT_GT(deviation, 0.15);  // the pattern must have contrast
  // The tolerance is three standard errors, plus 0.002 for the hue's rounding to three digits.
  EXPECT_NEAR(mean, 1.0, 3.0 * deviation / std::sqrt(kPoints) + 0.002);
}

TEST(FieldPattern, FadesToItsMeanFarAway) {
  CounterRandom random(3, 4);
  for (int i = 0; i < 100; ++i) {
    const glm::vec2 place_m = Between(random, glm::vec2(-3e5F), glm::vec2(6e5F));
    const glm::vec3 factor = FieldPattern::Plains().Reflectance(place_m, glm::vec2(60e3F), 1.0F);
    EXPECT_NEAR(Luminance(kPlain * factor) / Luminance(kPlain), 1.0, 0.01);
  }
}

// Returns the root mean square difference between one filtered value and the mean of many points in
// the same footprint (the ground area that a pixel covers).
double FilterError(const glm::vec2& footprint_m, bool filtered) {
  CounterRandom random(5, 6);
  double squares = 0.0;
  constexpr int kPlaces = 400;
  constexpr int kPoints = 400;
  for (int i = 0; i < kPlaces; ++i) {
    const glm::vec2 place_m = Between(random, glm::vec2(-5e4F), glm::vec2(1e5F));
    glm::vec3 sum(0.0F);
    for (int j = 0; j < kPoints; ++j) {
      const glm::vec2 at_m = Between(random, place_m - 0.5F * footprint_m, footprint_m);
      sum += FieldPattern::Plains().Reflectance(at_m, glm::vec2(0.0F), 1.0F);
    }
    const glm::vec2 used_m = filtered ? footprint_m : glm::vec2(0.0F);
    const glm::vec3 one = FieldPattern::Plains().Reflectance(place_m, used_m, 1.0F);
    const double difference = Luminance(one - sum / static_cast<float>(kPoints));
    squares += difference * difference;
  }
  return std::sqrt(squares / kPlaces);
}

// The sampled mean has a standard error of up to 0.015. The mip chain's linear filter also blurs a
// footprint of more than a cell of 402 m. It widens the footprint up to twice, equally in both
// directions, so a narrow footprint loses contrast.
TEST(FieldPattern, OneFilteredValueIsNearTheMeanOfManyPoints) {
  for (const glm::vec2 footprint_m :
       {glm::vec2(2.0F, 40.0F), glm::vec2(20.0F, 300.0F), glm::vec2(100.0F, 100.0F),
        glm::vec2(400.0F, 90.0F), glm::vec2(800.0F, 800.0F), glm::vec2(200.0F, 3000.0F),
        glm::vec2(3000.0F, 3000.0F)}) {
    const bool within_cell = footprint_m.x < 402.0F && footprint_m.y < 402.0F;
    EXPECT_LT(FilterError(footprint_m, true), within_cell ? 0.05 : 0.09)
        << footprint_m.x << " x " << footprint_m.y;
    EXPECT_LT(FilterError(footprint_m, true), 0.5 * FilterError(footprint_m, false))
        << footprint_m.x << " x " << footprint_m.y;
  }
}

// The pattern must not change abruptly when the view moves by a small fraction of a pixel.
TEST(FieldPattern, MovesSmoothlyUnderAFootprint) {
  const glm::vec2 footprint_m(60.0F, 500.0F);
  glm::vec3 last = FieldPattern::Plains().Reflectance(glm::vec2(0.0F), footprint_m, 1.0F);
  for (int i = 1; i < 20'000; ++i) {
    const glm::vec2 place_m(static_cast<float>(i) * 1.0F, static_cast<float>(i) * 0.7F);
    const glm::vec3 here = FieldPattern::Plains().Reflectance(place_m, footprint_m, 1.0F);
    // Each step moves the footprint by a sixtieth of its size. Over a whole footprint, a field and
    // a road may change the luminance by 1.5.
    EXPECT_NEAR(Luminance(here), Luminance(last), 0.05) << place_m.x;
    last = here;
  }
}

TEST(FieldPattern, ReflectsNoMoreThanItReceives) {
  CounterRandom random(7, 8);
  for (const float albedo : {0.2F, 0.5F, 0.8F, 1.0F}) {
    const float contrast = FieldContrast(albedo * kPlain);
    EXPECT_GE(contrast, 0.0F);
    for (int i = 0; i < 50'000; ++i) {
      const glm::vec2 place_m = Between(random, glm::vec2(-5e4F), glm::vec2(1e5F));
      const glm::vec3 seen =
          albedo * kPlain * FieldPattern::Plains().Reflectance(place_m, glm::vec2(0.0F), contrast);
      ASSERT_GE(std::min({seen.x, seen.y, seen.z}), 0.0F);
      ASSERT_LE(std::max({seen.x, seen.y, seen.z}), 1.0F) << albedo;
    }
  }
  EXPECT_EQ(FieldContrast(0.2F * kPlain), 1.0F);
}

TEST(FieldPattern, RoadsRunAlongSectionLines) {
  const glm::vec2 small(0.01F);
  EXPECT_NEAR(glsl::roads({0.0F, 400.0F}, small).x, 1.0F, 1e-3F);
  EXPECT_NEAR(glsl::roads({400.0F, 3.0F * 1609.344F + 5.0F}, small).x, 1.0F, 1e-3F);
  EXPECT_NEAR(glsl::roads({-5.0F, 400.0F}, small).x, 1.0F, 1e-3F);
  EXPECT_FLOAT_EQ(glsl::roads({7.0F, 400.0F}, small).x, 0.0F);
  EXPECT_FLOAT_EQ(glsl::roads({804.0F, 804.0F}, small).x, 0.0F);
  // A footprint as large as a whole section (a square mile) has the road's fraction of paint,
  // wherever the footprint lies.
  const float share = 12.0F / 1609.344F;
  for (const float x_m : {0.0F, 300.0F, 800.0F, 1500.0F}) {
    EXPECT_NEAR(glsl::roads({x_m, 0.4F * x_m}, glm::vec2(1609.344F)).x,
                2.0F * share - share * share, 1e-5F);
  }
}

TEST(FieldPattern, PivotsAreCirclesOfTheMeanOfTheirQuarter) {
  double sum = 0.0;
  constexpr int kSide = 400;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const glm::vec2 place_m =
          glm::vec2(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F) *
          (glsl::kQuarter_m / kSide);
      sum += glsl::pivot(place_m, glm::vec2(5.0F));
    }
  }
  EXPECT_NEAR(sum / (kSide * kSide), 0.0, 1e-3);
  EXPECT_GT(glsl::pivot({402.0F, 402.0F}, glm::vec2(1.0F)), 0.2F);
  EXPECT_LT(glsl::pivot({10.0F, 10.0F}, glm::vec2(1.0F)), -0.7F);
}

TEST(RingPaint, IsOnEveryTenthKilometreAndToTheNorth) {
  const glm::vec2 small(1.0F);
  const glm::vec2 north(0.0F, 1.0F);
  EXPECT_EQ(glsl::ring_paint({10e3F, 0.0F}, north, small, 1.0F), 1.0F);
  EXPECT_EQ(glsl::ring_paint({-14.1421F * 1e3F, -14.1421F * 1e3F}, north, small, 1.0F),
            1.0F);  // 20 km
  EXPECT_EQ(glsl::ring_paint({5e3F, 0.0F}, north, small, 1.0F), 0.0F);
  EXPECT_EQ(glsl::ring_paint({215e3F, 0.0F}, north, small, 1.0F), 0.0F);
  EXPECT_EQ(glsl::ring_paint({0.0F, 5e3F}, north, small, 1.0F), 1.0F);   // the line to the north
  EXPECT_EQ(glsl::ring_paint({0.0F, -5e3F}, north, small, 1.0F), 0.0F);  // none to the south
  EXPECT_EQ(glsl::ring_paint({500.0F, 10.5e3F}, north, small, 1.0F), 1.0F);  // an arrowhead
  EXPECT_EQ(glsl::ring_paint({500.0F, 9.5e3F}, north, small, 1.0F), 0.0F);
  // Lines widen to a pixel and a half.
  EXPECT_EQ(glsl::ring_paint({10.7e3F, 0.0F}, north, small, 1e3F), 1.0F);
  EXPECT_EQ(glsl::ring_paint({10.7e3F, 0.0F}, north, small, 100.0F), 0.0F);
  // The line points to true north, which here is the grid's east.
  const glm::vec2 east(1.0F, 0.0F);
  EXPECT_EQ(glsl::ring_paint({5e3F, 0.0F}, east, small, 1.0F), 1.0F);
  EXPECT_EQ(glsl::ring_paint({0.0F, 5e3F}, east, small, 1.0F), 0.0F);
}

}  // namespace
}  // namespace thunderhead::physics
