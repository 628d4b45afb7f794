#include "physics/land_use.h"

#include <cmath>

#include "glm/geometric.hpp"
#include "gtest/gtest.h"

namespace thunderhead::physics {
namespace {

const float kUnknown = std::nanf("");

float LandLuminance(const glm::vec3& rgb) {
  return glm::dot(rgb, glm::vec3(0.2126F, 0.7152F, 0.0722F));
}

TEST(LandUse, TellsWaterForestAndDesertOfBothTables) {
  EXPECT_TRUE(LandUseOf(LandUseScheme::kUsgs, 16).water);
  EXPECT_TRUE(LandUseOf(LandUseScheme::kModis, 17).water);
  EXPECT_TRUE(LandUseOf(LandUseScheme::kModis, 21).water);  // the class of lakes
  EXPECT_FALSE(LandUseOf(LandUseScheme::kModis, 16).water);
  EXPECT_FALSE(LandUseOf(LandUseScheme::kUsgs, 17).water);
  const glm::vec3 forest = LandUseOf(LandUseScheme::kUsgs, 14).hue;
  EXPECT_GT(forest.y, 1.3F * forest.x);
  const glm::vec3 desert = LandUseOf(LandUseScheme::kModis, 16).hue;
  EXPECT_GT(desert.x, 1.2F * desert.y);
  EXPECT_EQ(LandUseOf(LandUseScheme::kUsgs, 24).albedo, 0.55F);  // the class of ice
  EXPECT_EQ(LandUseOf(LandUseScheme::kModis, 15).albedo, 0.55F);
}

TEST(LandUse, AnUnknownClassIsGrassland) {
  const LandUse grass = LandUseOf(LandUseScheme::kUsgs, 7);
  for (const int index : {-1, 0, 25, 1000}) {
    EXPECT_EQ(LandUseOf(LandUseScheme::kUsgs, index).hue, grass.hue);
    EXPECT_FALSE(LandUseOf(LandUseScheme::kModis, index).water);
  }
}

TEST(LandReflectance, HasTheAlbedoAsItsLuminance) {
  for (int index = 1; index <= 21; ++index) {
    const LandUse use = LandUseOf(LandUseScheme::kModis, index);
    for (const float green_percent : {0.0F, 30.0F, 100.0F, kUnknown}) {
      EXPECT_NEAR(LandLuminance(LandReflectance(use, {0.23F, green_percent, 0.3F})), 0.23F, 1e-4F);
      EXPECT_NEAR(LandLuminance(LandReflectance(use, {kUnknown, green_percent, 0.0F})), use.albedo,
                  1e-4F);
    }
  }
}

// In idealised runs, and at night in some schemes, the model's albedo is 0.
TEST(LandReflectance, TakesTheClassesAlbedoForNone) {
  const LandUse crops = LandUseOf(LandUseScheme::kUsgs, 2);
  EXPECT_NEAR(LandLuminance(LandReflectance(crops, {0.0F, kUnknown, kUnknown})), 0.17F, 1e-4F);
}

TEST(LandReflectance, SnowWhitensAndBrightens) {
  const LandUse crops = LandUseOf(LandUseScheme::kUsgs, 2);
  const glm::vec3 bare = LandReflectance(crops, {kUnknown, 50.0F, 0.0F});
  const glm::vec3 snow = LandReflectance(crops, {kUnknown, 50.0F, 1.0F});
  EXPECT_GT(LandLuminance(snow), 3.0F * LandLuminance(bare));
  EXPECT_NEAR(snow.x, snow.z, 0.05F);
  // If the model has an albedo, it already includes the snow.
  EXPECT_NEAR(LandLuminance(LandReflectance(crops, {0.6F, 50.0F, 1.0F})), 0.6F, 1e-4F);
}

TEST(LandReflectance, PlantsThatAreNotGreenAreDry) {
  const LandUse crops = LandUseOf(LandUseScheme::kUsgs, 3);
  const glm::vec3 summer = LandReflectance(crops, {kUnknown, 80.0F, 0.0F});
  const glm::vec3 winter = LandReflectance(crops, {kUnknown, 5.0F, 0.0F});
  EXPECT_GT(summer.y / summer.x, 1.2F);
  EXPECT_LT(winter.y / winter.x, 0.9F);
  const LandUse desert = LandUseOf(LandUseScheme::kUsgs, 19);
  EXPECT_EQ(LandReflectance(desert, {kUnknown, 80.0F, 0.0F}),
            LandReflectance(desert, {kUnknown, 5.0F, 0.0F}));
}

}  // namespace
}  // namespace thunderhead::physics
