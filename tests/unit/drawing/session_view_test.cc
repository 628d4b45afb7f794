// Tests of the state machine of a session, with a fake clock and no GL.
#include "drawing/session_view.h"

#include <chrono>
#include <tuple>

#include "drawing/light_tracing.h"
#include "gtest/gtest.h"
#include "tests/support/techniques.h"

namespace thunderhead::drawing {
namespace {

using std::chrono::milliseconds;
using State = SessionView::State;

constexpr session::Clock::time_point kStart{};
constexpr const char* kView = "view";

// Returns settings of 64 and 128 slices for every kind of camera.
accuracy::OfferTables Tables() {
  accuracy::PricedSettings table;
  table.size_px = {64, 36};
  accuracy::Setting setting{test_support::PlainScene().rendering.technique};
  for (const auto& [slices, ms, error] : {std::tuple{64, 10.0, 0.3}, std::tuple{128, 20.0, 0.2}}) {
    scene::SetCount(&setting.technique, slices);
    table.rows.push_back({setting, ms, error});
  }
  accuracy::OfferTables tables;
  tables.fill(table);
  tables[1] = absl::FailedPreconditionError("no table");
  return tables;
}

class SessionViewTest : public ::testing::Test {
 protected:
  SessionViewTest() { scene_.output = {64, 36, 88}; }

  // Changes the scene: the camera turns, if it can.
  void Change() {
    if (auto* orbit = std::get_if<scene::OrbitCamera>(&scene_.camera)) orbit->azimuth_deg += 1.0;
    newest_ = {++revision_, std::make_shared<const scene::Scene>(scene_), kStart};
  }

  // Ends the measurement of the error after its first step, which finds that no error can be
  // measured.
  void EndMeasuring(milliseconds since_change) {
    const SessionWork work = Next(since_change);
    const auto* trace = std::get_if<TraceLight>(&work);
    ASSERT_NE(trace, nullptr);
    EXPECT_TRUE(trace->error);
    EXPECT_FALSE(view_.ErrorMeasured({.ended = true}, kStart + since_change));
  }

  // Returns the session's next work at `since_change` after the last change, with the scene's
  // fields available.
  SessionWork Next(milliseconds since_change) {
    decided_ = **view_.Decide(newest_);
    return view_.Next(newest_, decided_, kStart + since_change, last_drawn_);
  }

  // Draws a frame if that is the next work; returns false otherwise.
  bool DrawNext(milliseconds since_change) {
    const SessionWork work = Next(since_change);
    const auto* draw = std::get_if<DrawFrame>(&work);
    if (draw == nullptr) return false;
    last_plan_ = draw->plan;
    Observe(draw->plan.quality, ms_per_mega_sample_);
    view_.Drawn(*draw);
    return true;
  }

  void Observe(const FrameQuality& quality, double ms_per_mega_sample) {
    const scene::Scene& scene = *decided_->scene;
    const double ms = ms_per_mega_sample * accuracy::MegaSamples(scene, quality);
    costs_.Observe(kView, {scene, quality, ms, {{scene::FrameStage::kView, ms}}});
    last_drawn_ = LastDrawn{scene, quality};
  }

  // Changes the scene several times, so that frames are known to be slow and the next frames are
  // coarse.
  void Drag() {
    for (int i = 0; i < 3; ++i) {
      Change();
      ASSERT_TRUE(DrawNext(milliseconds(0)));
    }
    ASSERT_FALSE(last_plan_.refined);
  }

  // Draws all frames before the checks, from coarse to full.
  void ComeToRest() {
    do {
      ASSERT_TRUE(DrawNext(milliseconds(600)));
    } while (last_plan_ != FramePlan{FrameQuality{}, true});
  }

  template <typename Work>
  bool NextIs(milliseconds since_change) {
    return std::holds_alternative<Work>(Next(since_change));
  }
  bool NextIsNothing(milliseconds since_change) {
    const SessionWork work = Next(since_change);
    const auto* wait = std::get_if<WaitUntil>(&work);
    return wait != nullptr && !wait->time.has_value();
  }

  const accuracy::OfferTables tables_ = Tables();
  accuracy::MachineCosts costs_{tables_};
  const accuracy::Offers offers_{tables_, costs_};
  SessionView view_{PlannerTargets{}, costs_, offers_, kView};
  scene::Scene scene_ = test_support::PlainScene();
  std::uint64_t revision_ = 0;
  session::NewestScene newest_;
  std::optional<session::NewestScene> decided_;
  std::optional<LastDrawn> last_drawn_;
  FramePlan last_plan_;
  double ms_per_mega_sample_ = 1000.0;
};

TEST_F(SessionViewTest, ASceneWithoutFieldsWaitsAndThenMoves) {
  Change();
  decided_ = **view_.Decide(newest_);
  const SessionWork work = view_.Next(newest_, std::nullopt, kStart, std::nullopt);
  EXPECT_TRUE(std::holds_alternative<WaitUntil>(work));
  EXPECT_EQ(view_.state(), State::kWaitingForFields);
  EXPECT_TRUE(NextIs<DrawFrame>(milliseconds(0)));
  EXPECT_EQ(view_.state(), State::kMoving);
}

TEST_F(SessionViewTest, FromMovingToRefiningToSettled) {
  Drag();
  EXPECT_EQ(view_.state(), State::kRefining);
  EXPECT_EQ(std::get<WaitUntil>(Next(milliseconds(10))).time, kStart + PlannerTargets{}.rest_delay);
  ComeToRest();
  EndMeasuring(milliseconds(10000));
  EXPECT_TRUE(NextIsNothing(milliseconds(10000)));
  EXPECT_EQ(view_.state(), State::kSettled);
  Change();
  EXPECT_TRUE(NextIs<DrawFrame>(milliseconds(0)));
  EXPECT_EQ(view_.state(), State::kMoving);
}

TEST_F(SessionViewTest, AFrameThatTakesLongComesOnceItsSceneHasRestedForAsLong) {
  scene_.output = {1280, 720, 88};
  ms_per_mega_sample_ = 100.0;  // 12 s for each full frame
  Drag();
  while (DrawNext(milliseconds(600))) {
  }
  ASSERT_NE(last_plan_, (FramePlan{FrameQuality{}, true}));
  const SessionWork work = Next(milliseconds(600));
  const auto* wait = std::get_if<WaitUntil>(&work);
  ASSERT_NE(wait, nullptr);
  EXPECT_EQ(view_.state(), State::kSettled);
  ASSERT_TRUE(wait->time.has_value());
  EXPECT_GT(*wait->time, kStart + milliseconds(5000));
  ASSERT_TRUE(DrawNext(milliseconds(15'000)));
  EXPECT_EQ(last_plan_, (FramePlan{FrameQuality{}, true}));
}

TEST_F(SessionViewTest, AGestureWithLongPausesRestsLater) {
  Drag();
  newest_.usual_pause = milliseconds(300);
  EXPECT_EQ(std::get<WaitUntil>(Next(milliseconds(90))).time, kStart + milliseconds(600));
  EXPECT_TRUE(NextIs<DrawFrame>(milliseconds(610)));
}

TEST_F(SessionViewTest, WhatAsksForAnErrorIsCheckedOnceItHasSettled) {
  scene_.accuracy = scene::MaxError{0.25};
  Change();
  ComeToRest();
  EXPECT_EQ(std::get<WaitUntil>(Next(milliseconds(400))).time,
            kStart + PlannerTargets{}.settle_delay);
  EXPECT_TRUE(NextIs<CheckSlices>(milliseconds(600)));
  EXPECT_EQ(view_.state(), State::kChecking);
  view_.Checked(0.02);
  EXPECT_EQ(view_.evidence().discretisation_error, 0.02);
  EndMeasuring(milliseconds(600));
  EXPECT_TRUE(NextIsNothing(milliseconds(600)));
  EXPECT_EQ(view_.state(), State::kSettled);
}

TEST_F(SessionViewTest, ASettingThatProvesTooSlowIsReplacedAndDrawnAnew) {
  scene_.accuracy = scene::MaxMilliseconds{22.0};
  Change();
  ComeToRest();
  EXPECT_EQ(scene::SlicesOf(decided_->scene->rendering.technique), 128);
  Observe(FrameQuality{}, 1000.0);  // the frame takes 295 ms
  EXPECT_TRUE(NextIs<CheckSlices>(milliseconds(600)));
  EXPECT_TRUE(NextIs<CheckSlices>(milliseconds(600))) << "until it is checked";
  view_.Checked(0.01);
  const SessionWork again = Next(milliseconds(600));
  EXPECT_EQ(std::get<WaitUntil>(again).time, kStart + milliseconds(600));
  EXPECT_EQ(view_.state(), State::kRefining);
  ASSERT_TRUE(DrawNext(milliseconds(600)));
  EXPECT_EQ(scene::SlicesOf(decided_->scene->rendering.technique), 64);
}

class YieldingViewTest : public SessionViewTest {
 protected:
  YieldingViewTest() {
    test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kDiffusion);
    std::get<scene::LightVolume>(scene_.rendering.technique).traced_light =
        scene::TracedLight::kAtRest;
  }

  static session::Clock::time_point After(milliseconds since_change) {
    return kStart + since_change;
  }
  std::optional<WaitUntil> Resting(milliseconds since_change) {
    return view_.Resting(**view_.Decide(newest_), After(since_change));
  }
};

TEST_F(YieldingViewTest, AViewWhosePictureIsComingKeepsWhatItNeeds) {
  Change();
  EXPECT_FALSE(view_.Yield(kStart, false));
  EXPECT_FALSE(view_.Yield(kStart, true));
  ASSERT_TRUE(DrawNext(milliseconds(0)));
  EXPECT_FALSE(view_.Yield(kStart, false)) << "finer ones follow";
}

TEST_F(YieldingViewTest, FinerFramesGiveWayToThoseWhoHaveNoPictureAndComeBack) {
  Drag();
  ASSERT_TRUE(view_.Yield(After(milliseconds(50)), true));
  EXPECT_EQ(Resting(milliseconds(60))->time, After(milliseconds(30'050)));
  EXPECT_FALSE(Resting(milliseconds(30'050)).has_value());
  ASSERT_TRUE(NextIs<DrawFrame>(milliseconds(30'050)));
  EXPECT_EQ(view_.state(), State::kRefining);
}

TEST_F(YieldingViewTest, TracingGivesWayForAWhileAndComesBack) {
  Change();
  ComeToRest();
  ASSERT_TRUE(NextIs<TraceLight>(milliseconds(600)));
  EXPECT_EQ(Resting(milliseconds(600)).has_value(), false);
  ASSERT_TRUE(view_.Yield(After(milliseconds(600)), false));
  EXPECT_EQ(Resting(milliseconds(700))->time, After(milliseconds(30'600)));
  EXPECT_FALSE(view_.StaysYielded(revision_, After(milliseconds(700)))) << "nothing was asked for";
  EXPECT_FALSE(Resting(milliseconds(30'600)).has_value());
  EXPECT_EQ(view_.state(), State::kWaitingForFields);
  // The scene's fields are refused once more, and then arrive.
  ASSERT_TRUE(view_.StaysYielded(revision_, After(milliseconds(30'700))));
  EXPECT_EQ(Resting(milliseconds(30'800))->time, After(milliseconds(60'700)));
  EXPECT_FALSE(Resting(milliseconds(60'700)).has_value());
  EXPECT_TRUE(NextIs<TraceLight>(milliseconds(60'800)));
}

TEST_F(YieldingViewTest, AChangeIsDrawnAtOnceAndItsRefusalIsTold) {
  Change();
  ComeToRest();
  ASSERT_TRUE(NextIs<TraceLight>(milliseconds(600)));
  ASSERT_TRUE(view_.Yield(After(milliseconds(600)), false));
  Change();
  EXPECT_FALSE(Resting(milliseconds(700)).has_value());
  EXPECT_FALSE(view_.StaysYielded(revision_, After(milliseconds(700))));
  EXPECT_TRUE(NextIs<DrawFrame>(milliseconds(700)));
}

TEST_F(SessionViewTest, AFinalPictureNeedsNothingUntilAChange) {
  Change();
  ComeToRest();
  EndMeasuring(milliseconds(10'000));
  ASSERT_TRUE(NextIsNothing(milliseconds(10'000)));
  ASSERT_TRUE(view_.Yield(kStart, false));
  const auto rests = view_.Resting(**view_.Decide(newest_), kStart + std::chrono::hours(1));
  ASSERT_TRUE(rests.has_value());
  EXPECT_FALSE(rests->time.has_value());
  Change();
  EXPECT_TRUE(NextIs<DrawFrame>(milliseconds(0)));
}

TEST(LightTracingTest, NothingIsShownBeforeThePathsCorrectTheLight) {
  LightTracing tracing;
  const session::Clock::time_point start;
  tracing.BeginFor(1, start);
  EXPECT_FALSE(tracing.Traced({1000, 1}, start));
  const session::Clock::time_point later = start + std::chrono::seconds(9);
  EXPECT_FALSE(tracing.Traced({accuracy::kMinCorrectingPaths - 1, 2}, later));
  EXPECT_TRUE(tracing.Traced({accuracy::kMinCorrectingPaths, 3}, later));
}

TEST_F(SessionViewTest, LightIsTracedAtRestUntilItHasEnoughPaths) {
  test_support::SetTransport(&scene_.rendering.technique, scene::Transport::kDiffusion);
  std::get<scene::LightVolume>(scene_.rendering.technique).traced_light =
      scene::TracedLight::kAtRest;
  Change();
  ComeToRest();
  EXPECT_EQ(std::get<WaitUntil>(Next(milliseconds(400))).time,
            kStart + PlannerTargets{}.settle_delay);
  ASSERT_TRUE(NextIs<TraceLight>(milliseconds(600)));
  EXPECT_EQ(view_.state(), State::kTracingLight);
  EXPECT_FALSE(view_.LightTraced({100'000, 1}, kStart + milliseconds(700))) << "too soon to show";
  EXPECT_FALSE(view_.LightTraced({140'000, 2}, kStart + milliseconds(1200))) << "too few more";
  EXPECT_TRUE(view_.LightTraced({150'000, 2}, kStart + milliseconds(1200)));
  EXPECT_TRUE(NextIs<ShowLight>(milliseconds(1200)));
  EXPECT_TRUE(NextIs<ShowLight>(milliseconds(1200))) << "until it is shown";
  view_.LightShown(kStart + milliseconds(1200));
  EXPECT_FALSE(view_.LightTraced({160'000, 3}, kStart + milliseconds(6100)));
  EXPECT_TRUE(view_.LightTraced({160'000, 3}, kStart + milliseconds(6200))) << "after five seconds";
  view_.LightShown(kStart + milliseconds(6200));
  ASSERT_TRUE(NextIs<TraceLight>(milliseconds(6200)));
  EXPECT_TRUE(
      view_.LightTraced({100'000 + accuracy::kTracedPaths, 4}, kStart + milliseconds(6300)));
  ASSERT_TRUE(NextIs<ShowLight>(milliseconds(6300))) << "all that was traced";
  view_.LightShown(kStart + milliseconds(6300));
  EndMeasuring(milliseconds(6300));
  EXPECT_TRUE(NextIsNothing(milliseconds(6300)));
  EXPECT_EQ(view_.state(), State::kSettled);
  Change();
  ComeToRest();
  EXPECT_TRUE(NextIs<TraceLight>(milliseconds(600)));
}

TEST_F(SessionViewTest, LightThatCannotBeTracedLeavesThePictureSettled) {
  scene_.rendering.technique = scene::LightVolume{};
  Change();
  ComeToRest();
  ASSERT_TRUE(NextIs<TraceLight>(milliseconds(600)));
  view_.LightFailed();
  ASSERT_TRUE(NextIs<ShowLight>(milliseconds(600))) << "to tell why";
  view_.LightShown(kStart + milliseconds(600));
  EndMeasuring(milliseconds(600));
  EXPECT_TRUE(NextIsNothing(milliseconds(600)));
  EXPECT_EQ(view_.state(), State::kSettled);
  EXPECT_TRUE(NextIsNothing(milliseconds(9000))) << "it is not tried again";
  Change();
  ComeToRest();
  EXPECT_TRUE(NextIs<TraceLight>(milliseconds(600)));
}

accuracy::ErrorProgress Measured(double low, double value, double high, bool ended = false) {
  accuracy::ErrorProgress progress{.ended = ended};
  progress.error.emplace().relative_rmse = {value, low, high};
  return progress;
}

TEST_F(SessionViewTest, TheErrorIsMeasuredAtRestAndToldAsItGetsClearer) {
  Change();
  ComeToRest();
  const SessionWork work = Next(milliseconds(600));
  const auto* trace = std::get_if<TraceLight>(&work);
  ASSERT_NE(trace, nullptr);
  EXPECT_FALSE(trace->light) << "it has none";
  EXPECT_TRUE(trace->error);
  const auto at = [](int ms) { return kStart + milliseconds(ms); };
  EXPECT_FALSE(view_.ErrorMeasured({}, at(700)));
  EXPECT_FALSE(view_.ErrorMeasured(Measured(0.0, 0.1, 0.5), at(800))) << "the table says more";
  EXPECT_FALSE(view_.evidence().measured.has_value());
  EXPECT_TRUE(view_.ErrorMeasured(Measured(0.1, 0.2, 0.3), at(900)));
  ASSERT_TRUE(NextIs<ShowLight>(milliseconds(900)));
  EXPECT_EQ(view_.evidence().measured->relative_rmse.high, 0.3);
  view_.LightShown(at(900));
  EXPECT_TRUE(NextIs<TraceLight>(milliseconds(900)));
  EXPECT_FALSE(view_.ErrorMeasured(Measured(0.15, 0.2, 0.25), at(1000))) << "too soon";
  EXPECT_FALSE(view_.ErrorMeasured(Measured(0.11, 0.2, 0.29), at(2000))) << "hardly clearer";
  EXPECT_TRUE(view_.ErrorMeasured(Measured(0.15, 0.2, 0.25), at(2000)));
  view_.LightShown(at(2000));
  EXPECT_TRUE(view_.ErrorMeasured(Measured(0.18, 0.2, 0.22, true), at(2100))) << "the last";
  ASSERT_TRUE(NextIs<ShowLight>(milliseconds(2100)));
  view_.LightShown(at(2100));
  EXPECT_TRUE(NextIsNothing(milliseconds(2100)));
  EXPECT_EQ(view_.state(), State::kSettled);
  Change();
  ComeToRest();
  EXPECT_TRUE(NextIs<TraceLight>(milliseconds(600)));
  EXPECT_FALSE(view_.evidence().measured.has_value()) << "of another picture";
}

// The table says that 64 slices have an error of 0.3, and 128 slices an error of 0.2.
class RefutedSettingTest : public SessionViewTest {
 protected:
  void Ask(double max_error) {
    scene_.accuracy = scene::MaxError{max_error};
    Change();
    ComeToRest();
    ASSERT_TRUE(NextIs<CheckSlices>(milliseconds(600)));
    view_.Checked(0.01);
    ASSERT_TRUE(NextIs<TraceLight>(milliseconds(600)));
  }
  std::optional<int> Slices() const {
    return scene::SlicesOf(decided_->scene->rendering.technique);
  }
  void Measure(double low, double value, double high) {
    view_.ErrorMeasured(Measured(low, value, high), kStart + milliseconds(900));
  }
};

TEST_F(RefutedSettingTest, AnotherIsDrawnOnceTheErrorIsSurelyAboveTheLimit) {
  Ask(0.35);
  EXPECT_EQ(Slices(), 64);
  Measure(0.30, 0.40, 0.50);
  ASSERT_TRUE(NextIs<ShowLight>(milliseconds(900))) << "it may be within the limit";
  view_.LightShown(kStart + milliseconds(900));
  Measure(0.38, 0.45, 0.50);
  const SessionWork again = Next(milliseconds(950));
  EXPECT_EQ(std::get<WaitUntil>(again).time, kStart + milliseconds(950));
  EXPECT_EQ(view_.state(), State::kRefining);
  EXPECT_FALSE(view_.evidence().measured.has_value()) << "of the other setting's picture";
  ComeToRest();
  EXPECT_EQ(Slices(), 128);
  Change();
  ASSERT_TRUE(DrawNext(milliseconds(0)));
  EXPECT_EQ(Slices(), 128) << "the same storm, asked for the same error";
  scene_.accuracy = scene::MaxError{0.36};
  Change();
  ASSERT_TRUE(DrawNext(milliseconds(0)));
  EXPECT_EQ(Slices(), 64) << "asked for another";
}

TEST_F(RefutedSettingTest, WhereNoneIsBetterThePictureStays) {
  Ask(0.25);
  EXPECT_EQ(Slices(), 128);
  Measure(0.38, 0.45, 0.50);
  EXPECT_TRUE(NextIs<ShowLight>(milliseconds(900)));
  EXPECT_EQ(view_.evidence().measured->relative_rmse.value, 0.45);
  EXPECT_EQ(Slices(), 128);
}

TEST_F(SessionViewTest, TheReferenceIsShownAndNothingDrawn) {
  scene_.rendering.technique = scene::Reference{};
  Change();
  EXPECT_TRUE(NextIs<ShowReference>(milliseconds(0)));
  view_.ReferenceShown(revision_);
  EXPECT_TRUE(NextIs<ShowReference>(milliseconds(10000)));
  EXPECT_EQ(view_.state(), State::kReference);
}

TEST_F(SessionViewTest, AFailureIsNotTriedAgainUntilTheSceneChanges) {
  Change();
  ASSERT_TRUE(NextIs<DrawFrame>(milliseconds(0)));
  view_.Failed(revision_);
  EXPECT_TRUE(NextIsNothing(milliseconds(10000)));
  EXPECT_EQ(view_.state(), State::kFailed);
  Change();
  EXPECT_TRUE(NextIs<DrawFrame>(milliseconds(0)));
}

TEST_F(SessionViewTest, AFailedReferenceIsNotShownAgain) {
  scene_.rendering.technique = scene::Reference{};
  Change();
  EXPECT_TRUE(NextIs<ShowReference>(milliseconds(0)));
  view_.Failed(revision_);
  EXPECT_TRUE(NextIsNothing(milliseconds(0)));
  EXPECT_EQ(view_.state(), State::kFailed);
}

TEST_F(SessionViewTest, AnOlderFailureDoesNotStopTheNewest) {
  Drag();
  view_.Failed(revision_ - 1);
  EXPECT_EQ(view_.state(), State::kRefining);
  EXPECT_FALSE(NextIsNothing(milliseconds(10)));
}

TEST_F(SessionViewTest, ASettingThatCannotBeDecidedIsAnErrorOnce) {
  scene_.accuracy = scene::MaxError{0.25};
  scene_.camera = scene::SpotterCamera{};
  Change();
  EXPECT_FALSE(view_.Decide(newest_).ok());
  EXPECT_EQ(view_.state(), State::kFailed);
  const auto again = view_.Decide(newest_);
  ASSERT_TRUE(again.ok());
  EXPECT_FALSE(again->has_value());
}

TEST_F(SessionViewTest, FieldsThatComeBackBeginNothingAnew) {
  Change();
  ComeToRest();
  EndMeasuring(milliseconds(10000));
  EXPECT_TRUE(NextIsNothing(milliseconds(10000)));
  view_.Next(newest_, std::nullopt, kStart, last_drawn_);
  EXPECT_EQ(view_.state(), State::kWaitingForFields);
  EXPECT_TRUE(NextIsNothing(milliseconds(10000)));
  EXPECT_EQ(view_.state(), State::kSettled);
}

TEST_F(SessionViewTest, WhatFailedForAWhileIsTriedAgainWhenThatIsOver) {
  Change();
  Next(milliseconds(0));
  view_.Failed(revision_, kStart + milliseconds(500));
  const SessionWork waits = Next(milliseconds(100));
  ASSERT_TRUE(std::holds_alternative<WaitUntil>(waits));
  EXPECT_EQ(std::get<WaitUntil>(waits).time, kStart + milliseconds(500));
  EXPECT_EQ(view_.state(), State::kFailed);
  EXPECT_FALSE(view_.TriesAgain(kStart + milliseconds(499)));
  EXPECT_TRUE(view_.TriesAgain(kStart + milliseconds(500)));
  EXPECT_FALSE(view_.TriesAgain(kStart + milliseconds(500))) << "once";
  EXPECT_TRUE(NextIs<DrawFrame>(milliseconds(500)));
  EXPECT_EQ(view_.state(), State::kMoving) << "nobody has seen it yet";
}

TEST_F(SessionViewTest, AFinerFrameThatFailedForAWhileIsTriedAgainAsOne) {
  Drag();
  ASSERT_TRUE(NextIs<DrawFrame>(milliseconds(600)));
  view_.Failed(revision_, kStart + milliseconds(700));
  EXPECT_TRUE(view_.TriesAgain(kStart + milliseconds(700)));
  EXPECT_TRUE(NextIs<DrawFrame>(milliseconds(700)));
  EXPECT_EQ(view_.state(), State::kRefining);
}

}  // namespace
}  // namespace thunderhead::drawing
