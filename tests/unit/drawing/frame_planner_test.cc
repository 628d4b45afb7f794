// Tests of the frame planner with a fake clock and fake costs.
#include "drawing/frame_planner.h"

#include <cmath>
#include <set>

#include "gtest/gtest.h"
#include "tests/support/techniques.h"

namespace thunderhead::drawing {
namespace {

using std::chrono::milliseconds;

constexpr session::Clock::time_point kPlannedAt{};
constexpr const char* kPlannedView = "view";

scene::Scene Hd() { return {}; }  // 1280 x 720, 128 slices: 118 million samples

session::NewestScene At(std::uint64_t revision, const scene::Scene& scene,
                        session::Clock::time_point changed_at) {
  return {revision, std::make_shared<const scene::Scene>(scene), changed_at};
}

// A machine whose frames cost exactly `fixed_ms` + `ms_per_mega_sample` x samples.
struct Machine {
  double fixed_ms = 0.0;
  double ms_per_mega_sample = 0.0;

  double Cost(const scene::Scene& scene, const FrameQuality& quality) const {
    return fixed_ms + ms_per_mega_sample * accuracy::MegaSamples(scene, quality);
  }
};

class FramePlannerTest : public ::testing::Test {
 protected:
  // Drags the camera through `count` scenes, each drawn as planned.
  void Drag(const Machine& machine, int count) {
    for (int i = 0; i < count; ++i) {
      std::get<scene::OrbitCamera>(scene_.camera).azimuth_deg += 1.0;
      ++revision_;
      const Decision decision =
          planner_.Decide(At(revision_, scene_, kPlannedAt), kPlannedAt, last_drawn_);
      ASSERT_TRUE(decision.plan.has_value());
      Draw(machine, *decision.plan);
    }
  }

  void Draw(const Machine& machine, const FramePlan& plan) {
    const double ms = machine.Cost(scene_, plan.quality);
    costs_.Observe(kPlannedView, {scene_, plan.quality, ms, {{scene::FrameStage::kSlices, ms}}});
    planner_.Drawn(revision_, plan);
    last_drawn_ = LastDrawn{scene_, plan.quality};
    last_plan_ = plan;
    last_ms_ = ms;
  }

  session::NewestScene AtPlanned() const { return At(revision_, scene_, kPlannedAt); }

  Decision Ask(milliseconds since_change) {
    return planner_.Decide(AtPlanned(), kPlannedAt + since_change, last_drawn_);
  }

  // Draws all frames that follow a change of the scene, and returns the drawing time of the last
  // frame in milliseconds.
  double DrawAllAt(milliseconds since_change, const Machine& machine) {
    for (int frames = 0; frames < 10; ++frames) {
      const auto plan = Ask(since_change).plan;
      if (!plan.has_value()) return last_ms_;
      Draw(machine, *plan);
    }
    ADD_FAILURE() << "it must come to an end";
    return last_ms_;
  }

  const accuracy::OfferTables tables_ = accuracy::OfferTables();
  accuracy::MachineCosts costs_{tables_};
  FramePlanner planner_{PlannerTargets{}, costs_, kPlannedView};
  scene::Scene scene_ = Hd();
  std::uint64_t revision_ = 0;
  std::optional<LastDrawn> last_drawn_;
  FramePlan last_plan_;
  double last_ms_ = 0.0;
};

TEST_F(FramePlannerTest, FastMachineDrawsFullQualityAtOnceAndOnce) {
  Drag({1.0, 0.05}, 10);  // 7 ms for each full frame
  EXPECT_EQ(last_plan_, (FramePlan{FrameQuality{}, true}));
  const Decision decision = Ask(milliseconds(10000));
  EXPECT_FALSE(decision.plan.has_value());
  EXPECT_FALSE(decision.ask_again_at.has_value());
}

// Other sessions wait while the thread draws a frame, so one slow scene must not block the server.
TEST_F(FramePlannerTest, NoFrameIsDrawnSoonThatOthersWouldWaitTooLongFor) {
  Drag({4.0, 100.0}, 20);  // 12 s for each full frame
  const double drawn_ms = DrawAllAt(milliseconds(1000), {4.0, 100.0});
  EXPECT_LE(drawn_ms, PlannerTargets{}.longest_ms);
  EXPECT_GT(drawn_ms, 0.3 * PlannerTargets{}.longest_ms);
  EXPECT_TRUE(last_plan_.refined);
  EXPECT_FALSE(Ask(milliseconds(1000)).ask_again_at.has_value());
  EXPECT_FALSE(planner_.DrawsWhole(scene_));
}

TEST_F(FramePlannerTest, AFullFrameComesOnceItsSceneHasRestedForAsLongAsItTakes) {
  const Machine machine{4.0, 100.0};
  Drag(machine, 20);
  DrawAllAt(milliseconds(1000), machine);
  int frames = 0;
  while (const auto finer_at = planner_.FinerAt(AtPlanned(), last_drawn_)) {
    ASSERT_LT(++frames, 10) << "it must come to an end";
    const auto since_change = std::chrono::duration_cast<milliseconds>(*finer_at - kPlannedAt);
    EXPECT_FALSE(Ask(since_change - milliseconds(100)).plan.has_value());
    const auto plan = Ask(since_change).plan;
    ASSERT_TRUE(plan.has_value());
    Draw(machine, *plan);
    EXPECT_GE(1.01 * static_cast<double>(since_change.count()), last_ms_);
  }
  EXPECT_EQ(last_plan_, (FramePlan{FrameQuality{}, true}));
}

TEST_F(FramePlannerTest, AFrameThatOthersWouldWaitForeverForIsNotDrawn) {
  const Machine machine{4.0, 1000.0};  // two minutes for each full frame
  Drag(machine, 20);
  const double drawn_ms = DrawAllAt(milliseconds(1'000'000), machine);
  EXPECT_LE(drawn_ms, PlannerTargets{}.longest_at_rest_ms);
  EXPECT_GT(drawn_ms, 0.3 * PlannerTargets{}.longest_at_rest_ms);
  EXPECT_FALSE(planner_.FinerAt(AtPlanned(), last_drawn_).has_value());
}

TEST_F(FramePlannerTest, AFrameThatTookTooLongByChanceIsRefinedAllTheSame) {
  Drag({4.0, 10.0}, 20);  // 1.2 s for each full frame
  // A slow frame may come from a compilation, or from other work on the processors.
  Drag({4.0, 100'000.0}, 1);
  Drag({4.0, 10.0}, 1);
  ASSERT_FALSE(last_plan_.refined);
  const auto plan = Ask(milliseconds(10000)).plan;
  ASSERT_TRUE(plan.has_value());
  EXPECT_TRUE(plan->refined);
  Draw({4.0, 10.0}, *plan);
  DrawAllAt(milliseconds(10000), {4.0, 10.0});
}

TEST_F(FramePlannerTest, AFrameOfASecondIsDrawnWhole) {
  Drag({4.0, 10.0}, 20);  // 1.2 s for each full frame
  EXPECT_TRUE(planner_.DrawsWhole(scene_));
}

TEST_F(FramePlannerTest, CoarseFramesComeToCostAboutTheTarget) {
  // With the first value, even a coarse frame at its finest quality takes only 18 ms.
  for (const double ms_per_mega_sample : {0.6, 1.0, 3.0, 10.0}) {
    Drag({4.0, ms_per_mega_sample}, 20);
    EXPECT_LE(last_ms_, 33.0) << ms_per_mega_sample;
    // One step of quality is a factor of 2^(3/4) in samples, so frames are at most one step below
    // the target.
    EXPECT_GE(last_ms_, 33.0 / std::pow(2.0, 0.75) - 4.0) << ms_per_mega_sample;
    EXPECT_FALSE(last_plan_.refined);
  }
}

TEST_F(FramePlannerTest, OnlyPicturesThatCanBeSparseAre) {
  const Machine machine{2.0, 0.15};  // 20 ms for each full frame
  Drag(machine, 5);
  EXPECT_EQ(last_plan_, (FramePlan{FrameQuality{1.0, 1.0, true}, false}));
  EXPECT_EQ(*Ask(milliseconds(80)).plan, (FramePlan{FrameQuality{}, true}));
  scene_.rendering.technique = scene::HalfAngle{};
  Drag(machine, 5);
  EXPECT_EQ(last_plan_, (FramePlan{FrameQuality{}, true}));
}

TEST_F(FramePlannerTest, CoarsestIsSomeShareOfHalfThePicture) {
  for (const bool sparse : {true, false}) {
    if (!sparse) scene_.rendering.technique = scene::HalfAngle{};
    Drag({0.0, 1000.0}, 20);
    const double share = sparse ? kCoarsestSparse : kCoarsest;
    EXPECT_EQ(last_plan_.quality, (FrameQuality{share, share, sparse, 0.5}));
  }
}

TEST_F(FramePlannerTest, SmallPicturesKeepTheirSize) {
  scene_.output.width_px = 640;
  scene_.output.height_px = 360;
  Drag({0.0, 10'000.0}, 20);
  EXPECT_EQ(last_plan_.quality.output_scale, 1.0);
}

// On this machine the coarsest frame takes 100 ms, nearly all of it in proportion to the number of
// pixels.
TEST_F(FramePlannerTest, CoarseFramesThatTakeTooLongAreSmallerAndKeepTheirSizeWithinAGesture) {
  const double samples = accuracy::MegaSamples(Hd(), {kCoarsestSparse, kCoarsestSparse, true});
  const Machine machine{2.0, 98.0 / samples};
  Drag(machine, 5);
  std::set<double> scales;
  for (int i = 0; i < 50; ++i) {
    Drag(machine, 1);
    scales.insert(last_plan_.quality.output_scale);
  }
  EXPECT_EQ(scales.size(), 1U);
  EXPECT_LE(last_ms_, PlannerTargets{}.whole_size_ms);
  EXPECT_GE(last_ms_, 0.6 * PlannerTargets{}.whole_size_ms);
  // If the machine has become faster, pictures have their full size again in the next gesture.
  const Machine quick{2.0, 10.0 / samples};
  for (int i = 0; i < 2; ++i) {
    Draw(quick, {FrameQuality{}, true});
    Drag(quick, 10);
  }
  EXPECT_EQ(last_plan_.quality.output_scale, 1.0);
}

TEST_F(FramePlannerTest, LargePicturesAreSmallerWhileTheyMove) {
  for (const scene::Technique& technique :
       {scene::Technique(scene::LightVolume{}), scene::Technique(scene::HalfAngle{})}) {
    scene_ = Hd();
    scene_.rendering.technique = technique;
    scene_.output.width_px = 3200;
    scene_.output.height_px = 1800;
    Drag({4.0, 0.1}, 5);  // some 74 ms for each full frame
    EXPECT_EQ(last_plan_.quality.output_scale, 0.5);
    EXPECT_FALSE(last_plan_.refined);
    const auto rested = Ask(milliseconds(80)).plan;
    ASSERT_TRUE(rested.has_value());
    EXPECT_EQ(*rested, (FramePlan{FrameQuality{}, true}));
  }
}

// A sparse picture costs processor time for each of its pixels, so a large picture is drawn whole
// if that is quick.
TEST_F(FramePlannerTest, LargePicturesAreWholeWhereThatIsQuick) {
  scene_.output.width_px = 3200;
  scene_.output.height_px = 1800;
  Drag({4.0, 0.03}, 5);  // 25 ms for each full frame
  EXPECT_EQ(last_plan_, (FramePlan{FrameQuality{}, true}));
}

TEST_F(FramePlannerTest, RefinesAfterTheDelayAtFullQualityWhenThatIsQuick) {
  Drag({2.0, 1.0}, 10);  // 120 ms for each full frame
  EXPECT_FALSE(last_plan_.refined);
  const Decision early = Ask(milliseconds(79));
  EXPECT_FALSE(early.plan.has_value());
  EXPECT_EQ(early.ask_again_at, kPlannedAt + milliseconds(80));
  const Decision decision = Ask(milliseconds(80));
  ASSERT_TRUE(decision.plan.has_value());
  EXPECT_EQ(*decision.plan, (FramePlan{FrameQuality{}, true}));
  Draw({2.0, 1.0}, *decision.plan);
  EXPECT_FALSE(Ask(milliseconds(10000)).plan.has_value());
}

TEST_F(FramePlannerTest, SlowMachineRefinesInTwoSteps) {
  const Machine machine{5.0, 10.0};  // 1185 ms for each full frame
  Drag(machine, 10);
  const Decision first = Ask(milliseconds(100));
  ASSERT_TRUE(first.plan.has_value());
  EXPECT_TRUE(first.plan->refined);
  EXPECT_TRUE(first.plan->quality.sparse) << "a smaller picture enlarged has rougher edges";
  EXPECT_LT(first.plan->quality.image_scale, 1.0);
  EXPECT_GT(first.plan->quality.image_scale, last_plan_.quality.image_scale);
  Draw(machine, *first.plan);
  EXPECT_LE(last_ms_, 180.0);
  const Decision between = Ask(milliseconds(300));
  EXPECT_FALSE(between.plan.has_value());
  EXPECT_EQ(between.ask_again_at, kPlannedAt + milliseconds(500));
  const Decision last = Ask(milliseconds(500));
  ASSERT_TRUE(last.plan.has_value());
  EXPECT_EQ(*last.plan, (FramePlan{FrameQuality{}, true}));
  Draw(machine, *last.plan);
  EXPECT_FALSE(Ask(milliseconds(10000)).plan.has_value());
}

TEST_F(FramePlannerTest, AChangeOfToneKeepsTheQualityThatIsThere) {
  const Machine machine{5.0, 10.0};
  Drag(machine, 5);
  Draw(machine, {FrameQuality{}, true});
  scene_.display.exposure_ev = scene_.display.exposure_ev.value_or(0.0) + 1.0;
  ++revision_;
  const Decision decision = Ask(milliseconds(0));
  ASSERT_TRUE(decision.plan.has_value());
  EXPECT_EQ(*decision.plan, (FramePlan{FrameQuality{}, true}));
}

// After a change of tone, the server must draw the rays of a sparse picture again. This must not
// take longer than the frame after any other change.
TEST_F(FramePlannerTest, AChangeOfToneAfterTheFirstFrameAtRestIsAsQuickAsAnyOther) {
  const Machine machine{5.0, 10.0};
  Drag(machine, 10);
  Draw(machine, *Ask(milliseconds(100)).plan);
  ASSERT_TRUE(last_plan_.quality.sparse);
  ASSERT_GT(last_ms_, 100.0);
  scene_.display.exposure_ev = scene_.display.exposure_ev.value_or(0.0) + 1.0;
  ++revision_;
  const Decision decision = Ask(milliseconds(0));
  ASSERT_TRUE(decision.plan.has_value());
  EXPECT_FALSE(decision.plan->refined);
  Draw(machine, *decision.plan);
  EXPECT_LE(last_ms_, 33.0);
}

TEST_F(FramePlannerTest, TheFirstFrameAtRestOfALargePictureHasNoFewerRays) {
  const Machine machine{5.0, 10.0};
  scene_.output.width_px = 3200;
  scene_.output.height_px = 1800;
  Drag(machine, 10);
  DrawAllAt(milliseconds(100), machine);
  EXPECT_FALSE(last_plan_.refined && last_plan_.quality.sparse);
}

// The frame's scale tells viewers whether a finer frame follows.
TEST_F(FramePlannerTest, AFirstFrameAtRestWithFewerRaysIsNeverOfTheFullScale) {
  const Machine machine{5.0, 3.0};  // 355 ms for each full frame; a sparse one takes less than 180
  Drag(machine, 10);
  const auto plan = Ask(milliseconds(100)).plan;
  ASSERT_TRUE(plan.has_value());
  EXPECT_TRUE(plan->quality.sparse);
  EXPECT_LT(plan->quality.image_scale, 1.0);
  EXPECT_GT(plan->quality.image_scale, 0.8);
}

TEST_F(FramePlannerTest, AChangeOfToneAfterAnotherSessionDrewIsCoarse) {
  const Machine machine{5.0, 10.0};
  Drag(machine, 5);
  Draw(machine, {FrameQuality{}, true});
  std::get<scene::OrbitCamera>(last_drawn_->scene.camera).azimuth_deg += 90.0;
  scene_.display.exposure_ev = scene_.display.exposure_ev.value_or(0.0) + 1.0;
  ++revision_;
  const Decision decision = Ask(milliseconds(0));
  ASSERT_TRUE(decision.plan.has_value());
  EXPECT_LT(decision.plan->quality.image_scale, 1.0);
}

TEST_F(FramePlannerTest, FailedSceneIsNotTriedAgain) {
  revision_ = 1;
  planner_.GiveUp(1);
  EXPECT_FALSE(Ask(milliseconds(0)).plan.has_value());
  EXPECT_FALSE(Ask(milliseconds(10000)).plan.has_value());
  revision_ = 2;
  EXPECT_TRUE(Ask(milliseconds(0)).plan.has_value());
}

}  // namespace
}  // namespace thunderhead::drawing
