// Tests of the ratio of measured to tabulated times, on plain values.
#include "accuracy/table_correction.h"

#include "accuracy/named_settings.h"
#include "gtest/gtest.h"
#include "tests/support/techniques.h"

namespace thunderhead::accuracy {
namespace {

Setting SlicesOf(int slices, const PlainTechnique& plain = test_support::kLightVolume) {
  Setting setting{plain.settings()};
  scene::SetCount(&setting.technique, slices);
  return setting;
}

TEST(TableCorrectionTest, WithoutMeasurementsTheTableIsBelieved) {
  EXPECT_EQ(TableCorrection().Factor(SlicesOf(64)), 1.0);
}

TEST(TableCorrectionTest, TheMostSpecialKnowledgeCounts) {
  TableCorrection correction;
  correction.Observe(SlicesOf(64), 10.0, 30.0);
  EXPECT_NEAR(correction.Factor(SlicesOf(64)), 3.0, 1e-9);
  EXPECT_NEAR(correction.Factor(SlicesOf(128)), 3.0, 1e-9);
  const Setting half_angle = SlicesOf(64, test_support::kHalfAngle);
  EXPECT_NEAR(correction.Factor(half_angle), 3.0, 1e-9);
  EXPECT_FALSE(correction.Knows(half_angle));
  correction.Observe(half_angle, 10.0, 5.0);
  EXPECT_TRUE(correction.Knows(half_angle));
  EXPECT_NEAR(correction.Factor(half_angle), 0.5, 1e-9);
  EXPECT_NEAR(correction.Factor(SlicesOf(512, test_support::kHalfAngle)), 0.5, 1e-9);
  EXPECT_NEAR(correction.Factor(SlicesOf(64)), 3.0, 1e-9);
}

TEST(TableCorrectionTest, FollowsAMachineAndForgetsAnOutlier) {
  TableCorrection correction;
  for (int i = 0; i < 20; ++i) correction.Observe(SlicesOf(64), 10.0, 20.0);
  correction.Observe(SlicesOf(64), 10.0, 2000.0);
  for (int i = 0; i < 10; ++i) correction.Observe(SlicesOf(64), 10.0, 20.0);
  // After ten more frames 0.7^10 = 0.028 of the outlier's effect remains; the effect was 0.3 times
  // the outlier's logarithm.
  EXPECT_NEAR(correction.Factor(SlicesOf(64)), 2.0, 2.0 * 0.05);
  for (const double nonsense_ms : {0.0, -1.0}) correction.Observe(SlicesOf(64), 10.0, nonsense_ms);
  EXPECT_NEAR(correction.Factor(SlicesOf(64)), 2.0, 2.0 * 0.05);
}

}  // namespace
}  // namespace thunderhead::accuracy
