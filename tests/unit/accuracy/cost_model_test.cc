// Tests of fitting the cost of a frame, on plain values.
#include "accuracy/cost_model.h"

#include "gtest/gtest.h"

namespace thunderhead::accuracy {
namespace {

TEST(CostModelTest, TellsFixedFromGrowingCost) {
  CostModel model;
  for (const double x : {1.0, 10.0, 100.0})
    model.Observe(x, 7.0 + 2.0 * x, {{scene::FrameStage::kSlices, 1.0}});
  EXPECT_NEAR(model.EstimateMs(50.0, scene::Stage::kView), 107.0, 1e-6);
}

TEST(CostModelTest, PreparationCountsOnlyWhenFieldsChange) {
  CostModel model;
  model.Observe(10.0, 70.0,
                {{scene::FrameStage::kExtinction, 30.0},
                 {scene::FrameStage::kUpload, 20.0},
                 {scene::FrameStage::kSlices, 20.0}});
  EXPECT_NEAR(model.EstimateMs(10.0, scene::Stage::kView), 20.0, 1e-6);
  EXPECT_NEAR(model.EstimateMs(10.0, scene::Stage::kExtinction), 70.0, 1e-6);
}

TEST(CostModelTest, CarryingLightCountsOnlyWhenItMustBeCarried) {
  CostModel model;
  model.Observe(10.0, 35.0, {{scene::FrameStage::kLight, 15.0}, {scene::FrameStage::kView, 20.0}});
  EXPECT_NEAR(model.EstimateMs(10.0, scene::Stage::kView), 20.0, 1e-6);
  EXPECT_NEAR(model.EstimateMs(10.0, scene::Stage::kLight), 35.0, 1e-6);
}

TEST(CostModelTest, FollowsAMachineThatSlowsDown) {
  CostModel model;
  for (int i = 0; i < 10; ++i) model.Observe(10.0, 10.0, {{scene::FrameStage::kSlices, 1.0}});
  for (int i = 0; i < 10; ++i) model.Observe(10.0, 40.0, {{scene::FrameStage::kSlices, 1.0}});
  // The ten fast frames still have a weight of 0.8^10 = 0.11.
  EXPECT_NEAR(model.EstimateMs(10.0, scene::Stage::kView), 40.0, 30.0 * 0.11);
}

TEST(CostModelTest, SmallFramesSayLittleOfLargeOnes) {
  // At its start with the software renderer, a server draws such frames: they take 20 ms, nearly
  // all of it a fixed cost per frame.
  CostModel start;
  for (int i = 0; i < 3; ++i) start.Observe(0.03, 20.0, {{scene::FrameStage::kSlices, 1.0}});
  EXPECT_LT(start.EstimateMs(4000.0, scene::Stage::kView), 20e3);
  // The frames have two sizes that hardly differ, and noise.
  CostModel noisy;
  noisy.Observe(0.01, 10.0, {{scene::FrameStage::kSlices, 1.0}});
  noisy.Observe(0.03, 20.0, {{scene::FrameStage::kSlices, 1.0}});
  EXPECT_LT(noisy.EstimateMs(4000.0, scene::Stage::kView), 40e3);
}

TEST(CostModelTest, FramesOfOneSizeOnASlowMachineTellOfLargerOnes) {
  CostModel model;
  for (int i = 0; i < 5; ++i) model.Observe(10.0, 150.0, {{scene::FrameStage::kSlices, 1.0}});
  EXPECT_NEAR(model.EstimateMs(100.0, scene::Stage::kView), 1500.0, 30.0);
}

TEST(CostModelTest, NoiseGivesNoNegativeEstimate) {
  CostModel model;
  model.Observe(1.0, 50.0, {{scene::FrameStage::kSlices, 1.0}});
  model.Observe(10.0, 5.0, {{scene::FrameStage::kSlices, 1.0}});
  EXPECT_GE(model.EstimateMs(0.0, scene::Stage::kView), 0.0);
  EXPECT_GE(model.EstimateMs(1000.0, scene::Stage::kView), 0.0);
}

}  // namespace
}  // namespace thunderhead::accuracy
