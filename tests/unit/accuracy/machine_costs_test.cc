// Tests of the costs that a machine learns from its frames, on fake times.
#include "accuracy/machine_costs.h"

#include "gtest/gtest.h"
#include "tests/support/techniques.h"

namespace thunderhead::accuracy {
namespace {

constexpr const char* kView = "view";
constexpr double kTableMs = 10.0;

// Returns tables with one row, a setting with 64 slices, for views from above.
OfferTables Tables() {
  PricedSettings table;
  table.size_px = {200, 100};
  Setting setting{test_support::kLightVolume.settings()};
  scene::SetCount(&setting.technique, 64);
  table.rows.push_back({setting, kTableMs, 0.3});
  OfferTables tables;
  tables.fill(absl::FailedPreconditionError("none"));
  tables[2] = table;
  return tables;
}

class MachineCostsTest : public ::testing::Test {
 protected:
  MachineCostsTest() {
    scene_.output = {200, 100, 88};
    scene_.camera = scene::TopDownCamera{};
    scene::SetSlices(&scene_.rendering.technique, 64);
  }

  void Observe(double ms, const FrameQuality& quality = {}, const std::string& view = kView,
               bool traced = false) {
    costs_.Observe(view, {scene_, quality, ms, {{scene::FrameStage::kView, ms}}, traced});
  }
  double FrameMs(const std::string& view = kView, const FrameQuality& quality = {}) const {
    return costs_.FrameMs(view, scene_, quality, scene::Stage::kView);
  }
  double SettingMs() const {
    const PricedSettings& table = *TableFor(tables_, scene_);
    return costs_.SettingMs(table, table.rows.front(), scene_);
  }

  const OfferTables tables_ = Tables();
  MachineCosts costs_{tables_};
  scene::Scene scene_ = test_support::PlainScene();
};

TEST_F(MachineCostsTest, OneFrameAnswersBothQuestions) {
  Observe(500.0);
  EXPECT_EQ(SettingMs(), kTableMs) << "its first frame compiles";
  EXPECT_FALSE(costs_.Knows(SettingOf(scene_)));
  Observe(30.0);
  EXPECT_NEAR(FrameMs(), 30.0, 1e-9);
  EXPECT_NEAR(SettingMs(), 30.0, 1e-9);
  EXPECT_TRUE(costs_.Knows(SettingOf(scene_)));
}

TEST_F(MachineCostsTest, EverySettingsFirstFrameCompiles) {
  for (const double ms : {500.0, 30.0}) Observe(ms);
  Observe(700.0, {}, kView, true);
  EXPECT_NEAR(SettingMs(), 30.0, 1e-9) << "the first with a correction";
  EXPECT_NEAR(FrameMs(), 30.0, 1e-9);
  const double compiling_ms = 800.0;
  costs_.Observe(kView, {.scene = scene_,
                         .total_ms = compiling_ms,
                         .stages = {{scene::FrameStage::kView, compiling_ms}},
                         .context = "worker"});
  EXPECT_NEAR(FrameMs(), 30.0, 1e-9) << "the first in another context";
  test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kPaper);
  Observe(900.0);
  EXPECT_NEAR(FrameMs(), 30.0, 1e-9) << "the first of another transport";
  scene::SetSlices(&scene_.rendering.technique, 128);
  Observe(60.0);
  EXPECT_NEAR(FrameMs(), 60.0, 1e-9) << "slices need no shaders";
}

TEST_F(MachineCostsTest, CoarseFramesTellTheViewsCostOnly) {
  for (const double ms : {500.0, 10.0}) Observe(ms, {0.5, 0.5});
  EXPECT_NEAR(FrameMs(kView, {0.5, 0.5}), 10.0, 1e-9);
  EXPECT_NEAR(FrameMs(), 80.0, 1e-9);
  EXPECT_EQ(SettingMs(), kTableMs);
}

TEST_F(MachineCostsTest, ViewsAreEstimatedApartAndNewOnesByTheMachine) {
  for (const double ms : {500.0, 10.0}) Observe(ms, {}, "thin");
  Observe(90.0, {}, "dense");
  EXPECT_NEAR(FrameMs("thin"), 10.0, 1e-9);
  EXPECT_GT(FrameMs("dense"), FrameMs("thin"));
  EXPECT_EQ(FrameMs("new"), FrameMs("dense")) << "as long as it began with the machine's";
  costs_.Forget("thin");
  EXPECT_EQ(FrameMs("thin"), FrameMs("new"));
}

TEST_F(MachineCostsTest, TechniquesAreEstimatedApart) {
  scene::Scene slices = scene_;
  test_support::SetTechnique(&slices.rendering.technique, test_support::kHalfAngle);
  for (const double ms : {500.0, 80.0}) {
    costs_.Observe(kView, {slices, {}, ms, {{scene::FrameStage::kSlices, ms}}});
  }
  for (const double ms : {500.0, 20.0}) Observe(ms);
  EXPECT_NEAR(costs_.FrameMs(kView, slices, {}, scene::Stage::kView), 80.0, 1e-6);
  EXPECT_NEAR(FrameMs(), 20.0, 1e-6);
}

}  // namespace
}  // namespace thunderhead::accuracy
