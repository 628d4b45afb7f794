// Tests of the sizes at which a reference is refined and of when it is shown, on plain values.
#include "drawing/reference_schedule.h"

#include <cmath>
#include <vector>

#include "gtest/gtest.h"

namespace thunderhead::drawing {
namespace {

delivery::Refinement After(int samples) {
  delivery::Refinement refinement;
  refinement.samples_per_pixel = samples;
  if (samples > 1) refinement.relative_error = 2.0 / std::sqrt(samples);
  return refinement;
}

TEST(ReferenceScheduleTest, BeginsSmallAndDoublesUpToTheFullSize) {
  ReferenceSchedule schedule({1280, 720});
  std::vector<glm::ivec2> sizes;
  while (!schedule.IsFull()) {
    sizes.push_back(schedule.SizePx());
    EXPECT_FALSE(schedule.GrowAt(After(7)));
    ASSERT_TRUE(schedule.GrowAt(After(8)));
  }
  sizes.push_back(schedule.SizePx());
  EXPECT_EQ(sizes,
            (std::vector<glm::ivec2>{{80, 45}, {160, 90}, {320, 180}, {640, 360}, {1280, 720}}));
  EXPECT_FALSE(schedule.GrowAt(After(1000)));
}

TEST(ReferenceScheduleTest, SmallPicturesAreFullAtOnce) {
  EXPECT_TRUE(ReferenceSchedule({64, 36}).IsFull());
  EXPECT_EQ(ReferenceSchedule({1, 1}).SizePx(), glm::ivec2(1, 1));
  // The picture is so narrow that halving would leave no pixels.
  const ReferenceSchedule line({8192, 1});
  EXPECT_EQ(line.SizePx(), glm::ivec2(4096, 1));
}

TEST(ReferenceScheduleTest, ShowsTheFirstSampleThenEachDoubling) {
  ReferenceSchedule schedule({64, 36});
  std::vector<int> shown;
  for (int samples = 0; samples <= 64; ++samples) {
    if (schedule.ShowNow(After(samples), 0.1)) shown.push_back(samples);
  }
  EXPECT_EQ(shown, (std::vector<int>{1, 2, 4, 8, 16, 32, 64}));
}

TEST(ReferenceScheduleTest, ShowsAtLeastOnceASecond) {
  ReferenceSchedule schedule({64, 36});
  ASSERT_TRUE(schedule.ShowNow(After(100), 0.1));
  EXPECT_FALSE(schedule.ShowNow(After(101), 0.9));
  EXPECT_TRUE(schedule.ShowNow(After(101), 1.0));
}

TEST(ReferenceScheduleTest, ALargerPictureIsShownFromTwoSamples) {
  ReferenceSchedule schedule({160, 90});
  ASSERT_FALSE(schedule.IsFull());
  ASSERT_TRUE(schedule.ShowNow(After(8), 0.1));
  ASSERT_TRUE(schedule.GrowAt(After(8)));
  EXPECT_FALSE(schedule.ShowNow(After(0), 5.0));
  EXPECT_FALSE(schedule.ShowNow(After(1), 5.0));
  EXPECT_TRUE(schedule.ShowNow(After(2), 0.1));
}

TEST(ReferenceScheduleTest, TheLastOfASizeIsShown) {
  ReferenceSchedule schedule({160, 90});
  ASSERT_TRUE(schedule.ShowNow(After(5), 0.1));
  EXPECT_FALSE(schedule.ShowNow(After(7), 0.1));
  EXPECT_TRUE(schedule.ShowNow(After(8), 0.1));
}

TEST(ReferenceScheduleTest, AsksForNoMoreThanTheNextPictureNeeds) {
  ReferenceSchedule schedule({64, 36});
  EXPECT_EQ(schedule.UntilSamples(), 1);
  ASSERT_TRUE(schedule.ShowNow(After(1), 0.1));
  EXPECT_EQ(schedule.UntilSamples(), 2);
  ASSERT_TRUE(schedule.ShowNow(After(40), 1.0));
  EXPECT_EQ(schedule.UntilSamples(), 80);
}

TEST(ReferenceScheduleTest, EndsWhenNobodyCouldSeeADifference) {
  const ReferenceSchedule schedule({64, 36});
  EXPECT_FALSE(schedule.Finished(After(1000)));
  delivery::Refinement exact = After(1000);
  exact.relative_error = 0.0005;
  EXPECT_TRUE(schedule.Finished(exact));
  // An empty sky has an error of 0 after two samples, but the samples may have missed a cloud's
  // edge.
  exact.samples_per_pixel = 2;
  EXPECT_FALSE(schedule.Finished(exact));
  EXPECT_TRUE(schedule.Finished(After(1 << 16)));
  EXPECT_FALSE(ReferenceSchedule({1280, 720}).Finished(After(1 << 16)));
}

}  // namespace
}  // namespace thunderhead::drawing
