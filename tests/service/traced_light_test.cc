// Tests of sessions and pictures with the path-traced correction, on a fake machine that traces a
// hundred thousand paths at a time.
#include <algorithm>
#include <vector>

#include "accuracy/named_settings.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/support/manual_time.h"
#include "tests/support/techniques.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;
using Messages = std::vector<v1::WatchFramesResponse>;

v1::Scene WithTracedLight() {
  v1::Scene scene = SmallScene();
  v1::LightVolume& light_volume = *scene.mutable_rendering()->mutable_light_volume();
  light_volume.set_transport(v1::TRANSPORT_DIFFUSION);
  light_volume.set_traced_light(v1::TRACED_LIGHT_AT_REST);
  return scene;
}

// A fixture whose time advances only where a test advances it.
class TracedLightTest : public ::testing::Test {
 protected:
  ~TracedLightTest() override { service_.machine->tracing.Open(); }

  service::ServerOptions Options() const {
    service::ServerOptions options = Patient(time_);
    return options;
  }

  // Waits until this revision is shown at full quality, and then until the server begins to trace
  // its light.
  bool Settle(Watcher& watcher, std::uint64_t revision) {
    if (!watcher.AwaitFrame(revision, true)) return false;
    time_.Advance(seconds(1));
    return true;
  }

  // Draws a picture, and returns when the render loop has checked every session again.
  void GoAround() {
    v1::RenderImageRequest request;
    *request.mutable_scene() = SmallScene();
    v1::RenderImageResponse response;
    const grpc::Status status =
        Call(service_.stub(), &v1::ThunderheadService::Stub::RenderImage, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }

  static bool AwaitPaths(Watcher& watcher, std::uint64_t revision, std::uint64_t paths) {
    return watcher.Await([=](const Messages& messages) {
      return std::any_of(messages.begin(), messages.end(), [=](const auto& message) {
        return message.has_frame() && message.frame().scene_revision() == revision &&
               message.frame().modelled().traced_paths() >= paths;
      });
    });
  }

  ManualTime time_;
  FakeService service_{Options()};
};

TEST_F(TracedLightTest, FramesAreDrawnForMoreAndMorePathsUntilThereAreEnough) {
  service_.machine->tracing.Close();
  Watcher watcher(service_.stub(), service_.Open(WithTracedLight()));
  ASSERT_TRUE(Settle(watcher, 1));
  // The first step is shown as the beginning of the correction. Later steps are shown whenever the
  // number of traced paths has grown by half.
  service_.machine->tracing.LetOnePass();
  for (const std::uint64_t shown : {2, 3, 5}) {
    ASSERT_TRUE(service_.machine->tracing.AwaitWaiting(1));
    time_.Advance(milliseconds(600));
    service_.machine->tracing.LetPass(shown == 5 ? 2 : 1);
    ASSERT_TRUE(AwaitPaths(watcher, 1, 100'000 * shown));
  }
  service_.machine->tracing.Open();
  ASSERT_TRUE(AwaitPaths(watcher, 1, 4'100'000));
  std::uint64_t paths = 0;
  for (const v1::WatchFramesResponse& message : watcher.Messages()) {
    if (!message.has_frame() || message.frame().modelled().traced_paths() == 0) continue;
    EXPECT_TRUE(message.frame().refined());
    EXPECT_TRUE(message.frame().has_accuracy());
    EXPECT_GT(message.frame().modelled().traced_paths(), paths);
    paths = message.frame().modelled().traced_paths();
  }
  const std::int64_t traced = service_.machine->traced_paths;
  time_.Advance(seconds(60));
  GoAround();
  EXPECT_EQ(service_.machine->traced_paths, traced) << "traced on after its end";
}

TEST_F(TracedLightTest, AnotherViewGoesOnFromWhatIsTraced) {
  const std::string id = service_.Open(WithTracedLight());
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(Settle(watcher, 1));
  ASSERT_TRUE(AwaitPaths(watcher, 1, 4'000'000));
  v1::Scene scene = WithTracedLight();
  scene.mutable_camera()->mutable_orbit()->set_azimuth_deg(80.0F);
  const std::uint64_t revision = service_.Update(id, scene);
  ASSERT_TRUE(Settle(watcher, revision));
  ASSERT_TRUE(AwaitPaths(watcher, revision, 8'000'000));
}

TEST_F(TracedLightTest, NothingIsTracedForScenesThatDoNotAskOrCannotShowIt) {
  v1::Scene unasked = WithTracedLight();
  unasked.mutable_rendering()->mutable_light_volume()->set_traced_light(v1::TRACED_LIGHT_OFF);
  v1::Scene consistent = WithTracedLight();
  consistent.mutable_rendering()->mutable_light_volume()->set_transport(v1::TRANSPORT_CONSISTENT);
  Watcher first(service_.stub(), service_.Open(unasked));
  Watcher second(service_.stub(), service_.Open(consistent));
  Watcher traced(service_.stub(), service_.Open(WithTracedLight()));
  for (Watcher* const watcher : {&first, &second, &traced}) ASSERT_TRUE(Settle(*watcher, 1));
  // Light is traced for the sessions in turn, so it would have been traced for the other sessions
  // by now.
  ASSERT_TRUE(AwaitPaths(traced, 1, 4'100'000));
  EXPECT_EQ(service_.machine->Traced().size(), 41U);
  for (const scene::Scene& scene : service_.machine->Traced()) {
    const scene::Technique& technique = scene.rendering.technique;
    EXPECT_EQ(test_support::TransportOf(technique), scene::Transport::kDiffusion);
    EXPECT_EQ(scene::TracedLightOf(technique), scene::TracedLight::kAtRest);
  }
}

TEST_F(TracedLightTest, WhatCannotBeTracedIsSaidOnceAndThePictureStays) {
  service_.machine->cannot_trace_azimuth_deg = 123.0;
  v1::Scene scene = WithTracedLight();
  scene.mutable_sun()->set_azimuth_deg(123.0F);
  const std::string id = service_.Open(scene);
  Watcher watcher(service_.stub(), id);
  ASSERT_TRUE(Settle(watcher, 1));
  const auto is_told = [](const v1::WatchFramesResponse& message) {
    return std::ranges::any_of(
        message.frame().modelled().not_shown(), [](const v1::NotShown& entry) {
          return entry.code() == v1::NotShown::CODE_TRACED_LIGHT &&
                 entry.message().find("cannot trace that") != std::string::npos;
        });
  };
  ASSERT_TRUE(watcher.Await([&](const Messages& messages) {
    return std::any_of(messages.begin(), messages.end(), is_told);
  }));
  EXPECT_TRUE(watcher.NewestFrame().refined());
  time_.Advance(seconds(60));
  GoAround();
  EXPECT_EQ(service_.machine->trace_failures, 1);
  // All earlier messages have arrived when the next scene does.
  ASSERT_TRUE(watcher.AwaitFrame(service_.Update(id, SmallScene()), true));
  int told = 0;
  for (const v1::WatchFramesResponse& message : watcher.Messages()) {
    EXPECT_FALSE(message.has_problem());
    told += is_told(message) ? 1 : 0;
  }
  EXPECT_EQ(told, 1);
}

TEST_F(TracedLightTest, OtherSessionsAreDrawnMeanwhile) {
  service_.machine->tracing.Close();
  Watcher tracing(service_.stub(), service_.Open(WithTracedLight()));
  ASSERT_TRUE(Settle(tracing, 1));
  ASSERT_TRUE(service_.machine->tracing.AwaitWaiting(1));
  // The other session opens during a step.
  Watcher other(service_.stub(), service_.Open(SmallScene()));
  EXPECT_TRUE(other.AwaitFrame(1, true));
  EXPECT_EQ(service_.machine->traced_steps, 0);
}

TEST_F(TracedLightTest, OneSceneTooManyWaitsForItsTurn) {
  service_.machine->traces_enough = true;
  Watcher watcher(service_.stub(), service_.Open(WithTracedLight()));
  ASSERT_TRUE(Settle(watcher, 1));
  ASSERT_TRUE(WaitFor([&] { return service_.machine->trace_refusals == 1; }));
  // The server tries again as time passes.
  ASSERT_TRUE(WaitFor([&] {
    time_.Advance(milliseconds(100));
    return service_.machine->trace_refusals > 1;
  }));
  service_.machine->traces_enough = false;
  EXPECT_TRUE(WaitFor([&] {
    time_.Advance(milliseconds(100));
    return service_.machine->traced_steps == 41;
  }));
  EXPECT_TRUE(AwaitPaths(watcher, 1, 4'100'000));
  for (const v1::WatchFramesResponse& message : watcher.Messages()) {
    EXPECT_FALSE(message.has_problem());
  }
}

TEST_F(TracedLightTest, NoPictureIsDrawnForTooFewPaths) {
  service_.machine->paths_per_step = 10'000;
  service_.machine->tracing.Close();
  Watcher watcher(service_.stub(), service_.Open(WithTracedLight()));
  ASSERT_TRUE(Settle(watcher, 1));
  // The steps are so far apart in time that the server might show a picture after each of them.
  for (int step = 0; step < 3; ++step) {
    ASSERT_TRUE(service_.machine->tracing.AwaitWaiting(1));
    time_.Advance(milliseconds(600));
    service_.machine->tracing.LetOnePass();
  }
  EXPECT_TRUE(AwaitPaths(watcher, 1, 30'000));
  for (const v1::WatchFramesResponse& message : watcher.Messages()) {
    const std::uint64_t paths = message.frame().modelled().traced_paths();
    EXPECT_TRUE(paths == 0 || paths == 30'000) << paths;
  }
}

TEST_F(TracedLightTest, PicturesThatAwaitItWaitForAMillionPaths) {
  const auto paths_with = [&](v1::TracedLight traced_light) {
    v1::RenderImageRequest request;
    *request.mutable_scene() = WithTracedLight();
    request.mutable_scene()->mutable_rendering()->mutable_light_volume()->set_traced_light(
        traced_light);
    v1::RenderImageResponse response;
    const grpc::Status status =
        Call(service_.stub(), &v1::ThunderheadService::Stub::RenderImage, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response.modelled().traced_paths();
  };
  EXPECT_EQ(paths_with(v1::TRACED_LIGHT_AT_REST), 0U);
  EXPECT_EQ(paths_with(v1::TRACED_LIGHT_AWAITED), 1'000'000U);
}

accuracy::OfferTables TracedTables() {
  accuracy::PricedSettings table;
  table.size_px = {64, 36};
  accuracy::Setting setting{scene::LightVolume{}};
  table.rows.push_back({setting, 10.0, 0.11});
  for (const auto& [paths, error] : {std::pair{0.1, 0.08}, {0.5, 0.06}, {2.0, 0.05}}) {
    setting.million_paths = paths;
    table.rows.push_back({setting, 10.0, error});
  }
  accuracy::OfferTables tables;
  tables.fill(table);
  return tables;
}

TEST(TracedImageTest, AnErrorTakesAsManyPathsAsItNeeds) {
  service::ServerOptions options = Patient();
  options.render_loop.offer_tables = TracedTables;
  const auto paths_for = [&](float error) {
    FakeService service(options);
    v1::RenderImageRequest request;
    *request.mutable_scene() = SmallScene();
    request.mutable_scene()->mutable_accuracy()->set_max_error(error);
    v1::RenderImageResponse response;
    const grpc::Status status =
        Call(service.stub(), &v1::ThunderheadService::Stub::RenderImage, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(response.accuracy().has_unmet(), error < 0.04F)
        << response.accuracy().unmet().message();
    return response.modelled().traced_paths();
  };
  EXPECT_EQ(paths_for(0.2F), 0U);
  EXPECT_EQ(paths_for(0.085F), 100'000U);
  EXPECT_EQ(paths_for(0.07F), 500'000U);
  EXPECT_EQ(paths_for(0.055F), 2'000'000U);
  EXPECT_EQ(paths_for(0.01F), 4'000'000U);
}

}  // namespace
}  // namespace thunderhead::testing
