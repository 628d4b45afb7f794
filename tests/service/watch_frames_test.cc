// Tests of streams of frames to viewers: order, skipping, coarse and refined frames, problems,
// ends.
#include <algorithm>
#include <cstdlib>

#include "frame/image_codec.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/manual_time.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

v1::Scene Facing(float sun_azimuth_deg) {
  v1::Scene scene = SmallScene();
  scene.set_time_index(0);
  scene.mutable_sun()->set_azimuth_deg(sun_azimuth_deg);
  return scene;
}

v1::Scene AtTime(std::uint32_t time_index) {
  v1::Scene scene = SmallScene();
  scene.set_time_index(time_index);
  // The camera is complete, so only the render loop reads the storm.
  scene.mutable_camera()->mutable_orbit()->mutable_target();
  scene.mutable_camera()->mutable_orbit()->set_elevation_deg(4.0F);
  scene.mutable_camera()->mutable_orbit()->set_distance_m(50000.0F);
  return scene;
}

void ExpectPainted(const v1::Frame& frame, std::uint8_t red, std::uint8_t green) {
  const auto image = frame::DecodeJpeg(frame.jpeg());
  ASSERT_TRUE(image.ok()) << image.status();
  ASSERT_EQ(image->width_px, 64);
  ASSERT_EQ(image->height_px, 36);
  // Compares a pixel in the middle. JPEG with halved colour resolution is a few levels off.
  const std::size_t middle = 3U * (18U * 64U + 32U);
  EXPECT_NEAR(image->rgb[middle], red, 12);
  EXPECT_NEAR(image->rgb[middle + 1], green, 12);
}

TEST(WatchFramesTest, FrameShowsTheSceneAndSaysWhatItCost) {
  FakeService service;
  v1::Scene scene = Facing(180.0F);
  scene.set_time_index(2);
  scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(33.0F);
  Watcher watcher(service.stub(), service.Open(scene));
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  const v1::Frame frame = watcher.NewestFrame();
  EXPECT_EQ(frame.scene_revision(), 1U);
  EXPECT_EQ(frame.width_px(), 64U);
  EXPECT_EQ(frame.camera().orbit().azimuth_deg(), 33.0F);
  EXPECT_EQ(frame.modelled().slices(), 16U);
  EXPECT_EQ(frame.modelled().fields(0), v1::HYDROMETEOR_CLOUD);
  EXPECT_EQ(frame.modelled().device_bytes(), 4096U);
  EXPECT_EQ(frame.modelled().occupied_share(), 0.125F);
  EXPECT_EQ(frame.stages(frame.stages_size() - 1).stage(), v1::STAGE_ENCODE);
  ExpectPainted(frame, RedOf(2), GreenOf(180.0));
}

TEST(WatchFramesTest, WhoJoinsIsToldTheWholeSceneAndThenEveryChange) {
  FakeService service;
  v1::Scene scene = Facing(180.0F);
  scene.mutable_display()->set_exposure_ev(1.5F);
  const std::string id = service.Open(scene);
  Watcher host(service.stub(), id);
  ASSERT_TRUE(host.AwaitFrame(1, true));
  scene.mutable_sky()->set_turbidity(3.0F);
  const std::uint64_t revision = service.Update(id, scene);
  ASSERT_TRUE(host.AwaitFrame(revision, true));
  Watcher guest(service.stub(), id);
  ASSERT_TRUE(guest.AwaitFrame(revision, true));
  for (Watcher* watcher : {&host, &guest}) {
    v1::WatchFramesResponse told;
    std::uint64_t before = 0;
    for (const v1::WatchFramesResponse& message : watcher->Messages()) {
      if (!message.has_scene()) continue;
      EXPECT_GT(message.scene_revision(), before);
      EXPECT_GE(message.scene_revision(), message.frame().scene_revision());
      before = message.scene_revision();
      told = message;
    }
    EXPECT_TRUE(watcher->Messages().front().has_scene());
    EXPECT_EQ(told.scene_revision(), revision);
    EXPECT_EQ(told.scene().sky().turbidity(), 3.0F);
    EXPECT_EQ(told.scene().display().exposure_ev(), 1.5F);
    EXPECT_EQ(told.scene().sun().azimuth_deg(), 180.0F);
    // The scene is complete, as in CreateSession's response.
    EXPECT_EQ(told.scene().storm_id(), "anvil");
    EXPECT_TRUE(told.scene().rendering().light_volume().has_theta_f_deg());
    EXPECT_TRUE(told.scene().camera().orbit().has_distance_m());
  }
}

TEST(WatchFramesTest, NothingIsDrawnWithoutAViewer) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  service.Update(id, Facing(10.0F));
  // Another session is drawn several times meanwhile.
  const std::string watched = service.Open(Facing(20.0F));
  Watcher watcher(service.stub(), watched);
  for (int i = 0; i < 5; ++i) {
    const float azimuth_deg = 21.0F + static_cast<float>(i);
    ASSERT_TRUE(watcher.AwaitFrame(service.Update(watched, Facing(azimuth_deg)), true));
  }
  for (const auto& drawn : service.machine->Log()) EXPECT_GE(drawn.scene.sun.azimuth_deg, 20.0);
}

TEST(WatchFramesTest, TwoViewersSeeTheSameFrames) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  Watcher one(service.stub(), id);
  ASSERT_TRUE(one.AwaitFrame(1, true));
  Watcher other(service.stub(), id);
  ASSERT_TRUE(other.AwaitFrame(1, true));
  EXPECT_EQ(other.NewestFrame().sequence(), one.NewestFrame().sequence());
  const std::uint64_t revision = service.Update(id, Facing(90.0F));
  ASSERT_TRUE(one.AwaitFrame(revision, true));
  ASSERT_TRUE(other.AwaitFrame(revision, true));
  EXPECT_EQ(one.NewestFrame().jpeg(), other.NewestFrame().jpeg());
  EXPECT_NE(one.Messages().front().viewer_id(), other.Messages().front().viewer_id());
}

TEST(WatchFramesTest, AtMostTwoFramesGoUnacknowledgedAndTheSlowViewerSkips) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  Watcher slow(service.stub(), id, false);
  Watcher fast(service.stub(), id);
  ASSERT_TRUE(slow.AwaitFrame(1, false));
  std::uint64_t revision = 0;
  for (int i = 0; i < 10; ++i) {
    revision = service.Update(id, Facing(static_cast<float>(10 * i)));
    ASSERT_TRUE(fast.AwaitFrame(revision, true));
  }
  ASSERT_TRUE(slow.Await([](const auto& messages) { return messages.size() >= 2; }));
  EXPECT_EQ(slow.Messages().size(), 2U);
  slow.Acknowledge(slow.NewestFrame().sequence());
  ASSERT_TRUE(slow.AwaitFrame(revision, true));
  EXPECT_EQ(slow.Messages().size(), 3U);
}

TEST(WatchFramesTest, BurstOfUpdatesYieldsFewFramesAndTheLastIsShown) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  const std::size_t drawn_before = service.machine->Log().size();
  // Many updates arrive while the first of their scenes is drawn.
  service.machine->drawing.Close();
  std::uint64_t revision = service.Update(id, Facing(0.0F));
  ASSERT_TRUE(service.machine->drawing.AwaitWaiting(1));
  for (int i = 1; i < 100; ++i) revision = service.Update(id, Facing(static_cast<float>(i)));
  service.machine->drawing.Open();
  ASSERT_TRUE(watcher.AwaitFrame(revision, true));
  EXPECT_EQ(revision, 101U);
  EXPECT_EQ(watcher.NewestFrame().scene_revision(), revision);
  ExpectPainted(watcher.NewestFrame(), RedOf(0), GreenOf(99.0));
  // At most four pictures are drawn: those of the first and the last scene, and a refined picture
  // for each of the two that was coarse.
  EXPECT_LE(service.machine->Log().size() - drawn_before, 4U);
  std::uint64_t last = 0;
  for (const auto& message : watcher.Messages()) {
    EXPECT_GT(message.frame().sequence(), last);
    last = message.frame().sequence();
  }
}

TEST(WatchFramesTest, CoarseWhileChangingRefinedAtRest) {
  ManualTime time;  // drawing advances this clock, too
  FakeService service(Patient(time));
  service.machine->time = &time;
  service.machine->ms_per_mega_sample = 4800.0;  // 177 ms for each full frame: refined in one step
  const std::string id = service.Open(SmallScene());
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, false));
  time.Advance(std::chrono::seconds(1));
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  std::uint64_t revision = 0;
  for (int i = 0; i < 20; ++i) {
    revision = service.Update(id, Facing(static_cast<float>(i)));
    ASSERT_TRUE(watcher.AwaitFrame(revision, false));
  }
  EXPECT_FALSE(watcher.NewestFrame().refined());
  time.Advance(std::chrono::seconds(1));
  ASSERT_TRUE(watcher.AwaitFrame(revision, true));
  const auto log = service.machine->Log();
  const auto& last = log.back();
  EXPECT_EQ(last.quality, accuracy::FrameQuality{});
  const auto& before = log[log.size() - 2];
  EXPECT_LT(before.quality.image_scale, 1.0);
  EXPECT_EQ(before.scene, last.scene);
  // Nothing is drawn again once the resting picture is at full quality.
  time.Advance(std::chrono::minutes(1));
  const std::string other = service.Open(Facing(100.0F));
  Watcher other_watcher(service.stub(), other);
  ASSERT_TRUE(other_watcher.AwaitFrame(1, false));
  ASSERT_TRUE(other_watcher.AwaitFrame(service.Update(other, Facing(101.0F)), false));
  const auto later = service.machine->Log();
  for (std::size_t i = log.size(); i < later.size(); ++i) {
    EXPECT_GE(later[i].scene.sun.azimuth_deg, 100.0);
  }
}

TEST(WatchFramesTest, ReadErrorIsAProblemOfItsRevisionAndTheNextSceneIsDrawn) {
  FakeService service;
  service.store->FailAt(2, absl::DataLossError("wrfout_2: QCLOUD is truncated; copy it again"));
  const std::string id = service.Open(AtTime(0));
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  const std::uint64_t failing = service.Update(id, AtTime(2));
  ASSERT_TRUE(watcher.Await([](const auto& messages) { return messages.back().has_problem(); }));
  const v1::Problem problem = watcher.Messages().back().problem();
  EXPECT_EQ(problem.scene_revision(), failing);
  EXPECT_THAT(problem.message(), HasSubstr("QCLOUD is truncated"));
  const std::uint64_t good = service.Update(id, AtTime(3));
  ASSERT_TRUE(watcher.AwaitFrame(good, true));
  ExpectPainted(watcher.NewestFrame(), RedOf(3), GreenOf(255.0));
}

TEST(WatchFramesTest, SceneThatCannotBeDrawnIsAProblem) {
  FakeService service;
  service.machine->fails_above_exposure_ev = 5.0;
  const std::string id = service.Open(SmallScene());
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  v1::Scene scene = SmallScene();
  scene.mutable_display()->set_exposure_ev(6);
  const std::uint64_t failing = service.Update(id, scene);
  ASSERT_TRUE(watcher.Await([](const auto& messages) { return messages.back().has_problem(); }));
  EXPECT_EQ(watcher.Messages().back().problem().scene_revision(), failing);
  ASSERT_TRUE(watcher.AwaitFrame(service.Update(id, SmallScene()), true));
}

TEST(WatchFramesTest, LongReadOfOneSessionDoesNotHoldUpAnother) {
  FakeService service;
  const std::string reading = service.Open(AtTime(0));
  const std::string drawing = service.Open(AtTime(0));
  Watcher waiting(service.stub(), reading);
  Watcher watcher(service.stub(), drawing);
  ASSERT_TRUE(waiting.AwaitFrame(1, true));
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  service.store->reading.Close();
  const std::uint64_t unread = service.Update(reading, AtTime(1));
  ASSERT_TRUE(service.store->reading.AwaitWaiting(1));
  v1::Scene turned = AtTime(0);
  turned.mutable_camera()->mutable_orbit()->set_azimuth_deg(1.0F);
  ASSERT_TRUE(watcher.AwaitFrame(service.Update(drawing, turned), true));
  EXPECT_EQ(waiting.NewestFrame().scene_revision(), 1U);
  service.store->reading.Open();
  ASSERT_TRUE(waiting.AwaitFrame(unread, true));
  EXPECT_THAT(waiting.NewestFrame().jpeg(), ::testing::Not(::testing::IsEmpty()));
  // The duration of the read is reported with the first frame that needed this read.
  const auto messages = waiting.Messages();
  const auto first = std::find_if(messages.begin(), messages.end(), [&](const auto& message) {
    return message.frame().scene_revision() == unread;
  });
  EXPECT_EQ(first->frame().stages(0).stage(), v1::STAGE_READ);
}

TEST(WatchFramesTest, TimesScrubbedFasterThanTheDiskAreStillShown) {
  FakeService service;
  const std::string id = service.Open(AtTime(0));
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  service.store->reading.Close();
  const std::uint64_t passing = service.Update(id, AtTime(1));
  ASSERT_TRUE(service.store->reading.AwaitWaiting(1));
  service.Update(id, AtTime(2));
  const std::uint64_t newest = service.Update(id, AtTime(3));
  service.store->reading.LetOnePass();
  EXPECT_TRUE(watcher.Await([&](const auto& messages) {
    return std::any_of(messages.begin(), messages.end(), [&](const auto& message) {
      return message.frame().scene_revision() == passing;
    });
  }));
  service.store->reading.Open();
  ASSERT_TRUE(watcher.AwaitFrame(newest, true));
  EXPECT_EQ(service.store->Reads(), 3);  // time 2 was skipped
}

TEST(WatchFramesTest, SessionsTakeTurns) {
  FakeService service;
  service.machine->ms_per_mega_sample = 1000.0;
  const std::string busy = service.Open(SmallScene());
  const std::string other = service.Open(SmallScene());
  Watcher busy_watcher(service.stub(), busy);
  Watcher other_watcher(service.stub(), other);
  ASSERT_TRUE(other_watcher.AwaitFrame(1, true));
  std::atomic<bool> stop{false};
  std::thread hand([&] {
    for (int i = 0; !stop; ++i) service.Update(busy, Facing(static_cast<float>(i % 300)));
  });
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(
        other_watcher.AwaitFrame(service.Update(other, Facing(static_cast<float>(i))), false));
  }
  stop = true;
  hand.join();
}

TEST(WatchFramesTest, ClosingTheSessionEndsItsStreams) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  v1::CloseSessionRequest request;
  request.set_session_id(id);
  v1::CloseSessionResponse response;
  ASSERT_TRUE(Call(service.stub(), &Stub::CloseSession, request, &response).ok());
  const grpc::Status end = watcher.End();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(end.error_message(), "the session was closed");
}

TEST(WatchFramesTest, AViewerThatLeavesIsForgotten) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  Watcher leaving(service.stub(), id, false);
  ASSERT_TRUE(leaving.AwaitFrame(1, false));
  leaving.Cancel();
  EXPECT_EQ(leaving.End().error_code(), grpc::StatusCode::CANCELLED);
  Watcher staying(service.stub(), id);
  ASSERT_TRUE(staying.AwaitFrame(service.Update(id, Facing(90.0F)), true));
}

TEST(WatchFramesTest, AcknowledgingForAnotherIsNotFound) {
  FakeService service;
  v1::AcknowledgeFrameRequest request;
  request.set_session_id(service.Open(SmallScene()));
  request.set_viewer_id(77);
  v1::AcknowledgeFrameResponse response;
  const grpc::Status status = Call(service.stub(), &Stub::AcknowledgeFrame, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(status.error_message(), HasSubstr("viewer_id is 77"));
}

}  // namespace
}  // namespace thunderhead::testing
