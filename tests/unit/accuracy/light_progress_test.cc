// Tests of the progress of tracing light, on plain values.
#include "accuracy/light_progress.h"

#include "gtest/gtest.h"

namespace thunderhead::accuracy {
namespace {

TEST(LightProgressTest, GoesByPathsOrByStepsWhereRaysAreFew) {
  EXPECT_EQ((LightProgress{0, 0}).ShareOf(1000), 0.0);
  EXPECT_EQ((LightProgress{5000, 1}).ShareOf(20'000), 0.25);
  EXPECT_EQ((LightProgress{19'999, 1}).HasTraced(20'000), false);
  EXPECT_EQ((LightProgress{20'000, 1}).HasTraced(20'000), true);
  EXPECT_EQ((LightProgress{90'000, 1}).ShareOf(20'000), 1.0);
  EXPECT_EQ((LightProgress{0, 10}).ShareOf(6000), 0.5);
  EXPECT_EQ((LightProgress{0, 20}).HasTraced(6000), true);
  EXPECT_EQ((LightProgress{0, 1}).ShareOf(0), 1.0);
}

TEST(LightProgressTest, StepsWithoutPathsCorrectNothing) {
  EXPECT_FALSE((LightProgress{kMinCorrectingPaths - 1, 1'000'000}).Corrects());
  EXPECT_TRUE((LightProgress{kMinCorrectingPaths, 3}).Corrects());
}

}  // namespace
}  // namespace thunderhead::accuracy
