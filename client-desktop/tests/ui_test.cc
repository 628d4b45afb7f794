// Tests of the state behind the panels, with a session of a fake service in this process.
#include "desktop/ui.h"

#include <cstdint>
#include <limits>
#include <mutex>
#include <string>
#include <vector>

#include "client-cpp/tests/fake_service.h"
#include "desktop/kiosk.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/wait_for.h"

namespace thunderhead::desktop {
namespace {

using client::testing::FakeService;

class Listener final : public client::SessionListener {
 public:
  void Changed() override {}
  void StreamBegan() override {}
  void Received(v1::Frame /*frame*/, std::size_t /*bytes*/) override {}
  void SceneTaken(std::uint64_t /*revision*/, std::chrono::steady_clock::time_point) override {}
};

// A window whose user is in control of the session. The session's storm has six times.
class UiTest : public ::testing::Test {
 protected:
  UiTest() {
    service.answer_description = [this](const v1::DescribeStormRequest& request, auto& /*storm*/) {
      const std::lock_guard lock(mutex);
      described.push_back(request);
      return grpc::Status(grpc::StatusCode::NOT_FOUND, "no such storm");
    };
  }
  void SetUp() override {
    ASSERT_TRUE(Await([&] { return ui.state.link == client::Link::kLive; }));
    v1::Scene scene;
    scene.set_storm_id("moore");
    scene.set_time_index(3);
    service.SendScene(scene, 1);
    service.SendPresence(FakeService::kClient);
    ASSERT_TRUE(Await([&] { return ui.state.Steers() && ui.state.scene.time_index() == 3; }));
    ui.storms.storm.set_id("moore");
    for (int i = 0; i < 6; ++i) ui.storms.storm.add_times();
    // Answers of the catalogue that arrive later do not replace this storm.
    ui.storms.version = std::numeric_limits<std::uint64_t>::max();
  }
  bool Await(const std::function<bool()>& wanted) {
    return thunderhead::testing::WaitFor([&] {
      ui.Refresh();
      return wanted();
    });
  }
  void TurnSun() {
    ui.Edit("sun", [](v1::Scene& scene) { scene.mutable_sun()->set_azimuth_deg(10.0F); });
  }
  // Returns the indices of a storm's times whose descriptions were requested.
  std::vector<std::uint32_t> TimesDescribed(const std::string& storm_id) {
    const std::lock_guard lock(mutex);
    std::vector<std::uint32_t> times;
    for (const v1::DescribeStormRequest& request : described) {
      if (request.storm_id() == storm_id) times.push_back(request.time_index());
    }
    return times;
  }
  const v1::Scene& scene() const { return ui.state.scene; }

  std::mutex mutex;
  std::vector<v1::DescribeStormRequest> described;
  FakeService service;
  Listener listener;
  client::Session session{service.Connect(), {}, listener};
  client::Catalogue catalogue{service.Connect(), [] {}};
  Ui ui{session, catalogue};
};

TEST_F(UiTest, TimesThatArePlayedAreNoStepsOfTheHistory) {
  ui.ShowTime(2);
  TurnSun();
  ui.ShowTime(4, Ui::Recording::kUnrecorded);
  ui.Undo();
  EXPECT_FALSE(scene().sun().has_azimuth_deg());
  EXPECT_EQ(scene().time_index(), 4U);
  ui.Undo();
  EXPECT_EQ(scene().time_index(), 3U);
  ui.ShowTime(5, Ui::Recording::kUnrecorded);
  ui.Redo();
  ui.Redo();
  EXPECT_TRUE(scene().sun().has_azimuth_deg());
  EXPECT_EQ(scene().time_index(), 2U);
}

TEST_F(UiTest, AViewOfAKioskIsShownForItsTimeOnceItsPictureIsThere) {
  std::vector<v1::Scene> views(2);
  Kiosk kiosk(views, 10.0);
  Kiosk::TimePoint now{};
  const auto after = [&](int seconds) {
    now += std::chrono::seconds(seconds);
    kiosk.Advance(ui, now);
    return kiosk.shown();
  };
  EXPECT_EQ(after(0), 0);
  ui.state.scene_revision = 2;
  ui.frame.set_scene_revision(1);
  EXPECT_EQ(after(60), 0) << "there is no picture of it";
  ui.frame.set_scene_revision(2);
  EXPECT_EQ(after(9), 0);
  EXPECT_EQ(after(1), 1);
  ui.state.scene_revision = 3;
  EXPECT_EQ(after(119), 1) << "it may still come";
  EXPECT_EQ(after(9), 1);
  EXPECT_EQ(after(1), 0) << "it cannot be drawn";
}

TEST_F(UiTest, AKioskWarnsOfALossThatLasts) {
  const Kiosk kiosk({}, 10.0);
  const Kiosk::TimePoint live{};
  const auto warning_after = [&](auto past) { return kiosk.Warning(ui, live, live + past); };
  EXPECT_EQ(warning_after(std::chrono::hours(1)), "") << "the link is live";
  ui.state.link = client::Link::kLost;
  ui.state.reason = "The server cannot be reached";
  EXPECT_EQ(warning_after(std::chrono::milliseconds(9'999)), "") << "it may come back at once";
  EXPECT_EQ(warning_after(std::chrono::seconds(10)),
            "No connection to the server for less than a minute: this picture is old. "
            "The server cannot be reached");
  EXPECT_THAT(warning_after(std::chrono::minutes(3)), ::testing::HasSubstr("for 3 min"));
}

TEST_F(UiTest, ChangesOfTheSceneAreCounted) {
  const int before = ui.edits;
  TurnSun();
  TurnSun();
  EXPECT_EQ(ui.edits, before + 1) << "the second changes nothing";
  ui.Undo();
  EXPECT_EQ(ui.edits, before + 2);
}

TEST_F(UiTest, TheLastTimeIsDescribedIfTheSceneNamesNone) {
  v1::StormSummary& listed = *ui.storms.storms.add_storms();
  listed.set_id("tornado");
  listed.set_time_count(4);
  v1::Scene scene;
  scene.set_storm_id("tornado");
  service.SendScene(scene, 2);
  ASSERT_TRUE(Await([&] { return TimesDescribed("tornado").size() == 1; }));
  EXPECT_EQ(TimesDescribed("tornado"), std::vector<std::uint32_t>{3});
}

TEST_F(UiTest, PlayFromTheStartIsNoStepEither) {
  TurnSun();
  ui.ShowTime(5, Ui::Recording::kUnrecorded);
  ui.playback.loops = false;
  ui.TogglePlay();
  EXPECT_EQ(scene().time_index(), 0U);
  ui.Undo();
  EXPECT_FALSE(scene().sun().has_azimuth_deg());
  EXPECT_EQ(scene().time_index(), 0U);
}

TEST_F(UiTest, AnEditThatChangesNothingIsNoStep) {
  TurnSun();
  ui.ShowStorm("moore");
  ui.Undo();
  EXPECT_FALSE(scene().sun().has_azimuth_deg());
}

TEST_F(UiTest, AnotherStormEndsPlayAndCanBeUndone) {
  ui.TogglePlay();
  ui.ShowStorm("supercell");
  EXPECT_EQ(scene().storm_id(), "supercell");
  EXPECT_FALSE(ui.playback.playing());
  EXPECT_EQ(ui.time_count(), 0) << "the times of the storm before it";
  ui.Undo();
  EXPECT_EQ(scene().storm_id(), "moore");
  EXPECT_EQ(scene().time_index(), 3U);
}

TEST_F(UiTest, AStormThatSomebodyElseChoosesEndsTheHistory) {
  TurnSun();
  ASSERT_TRUE(Await([&] { return ui.state.scene_revision == 2; }));
  v1::Scene others = scene();
  others.set_storm_id("supercell");
  service.SendScene(others, 9);
  ASSERT_TRUE(Await([&] { return scene().storm_id() == "supercell"; }));
  ui.Undo();
  EXPECT_TRUE(scene().sun().has_azimuth_deg());
}

}  // namespace
}  // namespace thunderhead::desktop
