// Tests of sessions: opening, completing scenes, closing, expiring, and the limit on their number.
#include <cmath>

#include "glm/trigonometric.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "physics/sun_position.h"
#include "service/messages/sun_messages.h"
#include "tests/service/fake_service.h"
#include "tests/service/interacting.h"
#include "tests/support/running_time.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using Stub = v1::ThunderheadService::Stub;

v1::CreateSessionResponse CreateWith(FakeService& service, const v1::Scene& scene) {
  v1::CreateSessionRequest request;
  *request.mutable_scene() = scene;
  v1::CreateSessionResponse response;
  const grpc::Status status = Call(service.stub(), &Stub::CreateSession, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response;
}

grpc::Status Close(FakeService& service, const std::string& session_id) {
  v1::CloseSessionRequest request;
  request.set_session_id(session_id);
  v1::CloseSessionResponse response;
  return Call(service.stub(), &Stub::CloseSession, request, &response);
}

TEST(SessionsTest, EmptySceneComesBackWithEveryDefault) {
  FakeService service;
  const v1::CreateSessionResponse created = CreateWith(service, {});
  EXPECT_THAT(created.session_id(), MatchesRegex("[0-9a-f]{32}"));
  EXPECT_EQ(created.scene_revision(), 1U);
  const v1::Scene& scene = created.scene();
  EXPECT_EQ(scene.storm_id(), "anvil");
  EXPECT_EQ(scene.time_index(), 3U) << "the last";
  const v1::OrbitCamera& camera = scene.camera().orbit();
  EXPECT_EQ(camera.azimuth_deg(), 200.0F);
  EXPECT_EQ(camera.field_of_view_deg(), 35.0F);
  // The target is the middle of the one cell with condensate, (4, 4, 2).
  EXPECT_EQ(camera.target().x_m(), -5500.0F);
  EXPECT_EQ(camera.target().y_m(), -500.0F);
  EXPECT_EQ(camera.target().z_m(), 1250.0F);
  EXPECT_GT(camera.distance_m(), 1000.0F);
  EXPECT_EQ(scene.sun().elevation_deg(), 18.0F);
  EXPECT_TRUE(scene.sky().has_brightness());
  const v1::LightVolume& light_volume = scene.rendering().light_volume();
  EXPECT_EQ(light_volume.transport(), v1::TRANSPORT_DIFFUSION);
  EXPECT_EQ(light_volume.traced_light(), v1::TRACED_LIGHT_AT_REST);
  EXPECT_EQ(light_volume.slices(), 128U);
  EXPECT_TRUE(light_volume.per_field_phase());
  EXPECT_TRUE(light_volume.detail());
  EXPECT_TRUE(light_volume.has_false_colors());
  EXPECT_EQ(scene.display().tone_map(), v1::TONE_MAP_FILMIC);
  EXPECT_EQ(scene.output().width_px(), 1280U);
  EXPECT_EQ(scene.output().jpeg_quality(), 88U);
  ASSERT_EQ(scene.fields_size(), 2);
  EXPECT_EQ(scene.fields(0).hydrometeor(), v1::HYDROMETEOR_CLOUD);
  EXPECT_FALSE(scene.fields(0).has_radius_m());
  EXPECT_EQ(scene.particle_sizes(), v1::PARTICLE_SIZES_MODEL);
  EXPECT_EQ(scene.fields(0).phase().kind(), v1::PhaseFunction::KIND_WATER_DROPLETS);
  // The colour is #56B4E9.
  EXPECT_NEAR(scene.fields(1).false_color().blue(), 0.815F, 0.001F);
  EXPECT_TRUE(scene.fields(1).visible());
  EXPECT_EQ(scene.fields(1).sizes(), v1::PARTICLE_SIZES_UNSPECIFIED) << "the scene's";
}

TEST(SessionsTest, ValuesGivenAreKept) {
  FakeService service;
  v1::Scene wanted = SmallScene();
  wanted.mutable_camera()->mutable_orbit()->mutable_target()->set_x_m(123.0F);
  wanted.set_time_index(3);
  v1::FieldParameters& rain = *wanted.add_fields();
  rain.set_hydrometeor(v1::HYDROMETEOR_RAIN);
  rain.set_visible(false);
  rain.mutable_phase()->set_kind(v1::PhaseFunction::KIND_RAYLEIGH);
  const v1::Scene scene = CreateWith(service, wanted).scene();
  EXPECT_EQ(scene.time_index(), 3U);
  EXPECT_EQ(scene.camera().orbit().target().x_m(), 123.0F);
  EXPECT_EQ(scene.camera().orbit().target().z_m(), 0.0F);
  EXPECT_EQ(scene.output().width_px(), 64U);
  ASSERT_EQ(scene.fields_size(), 2);
  EXPECT_EQ(scene.fields(0).hydrometeor(), v1::HYDROMETEOR_RAIN);
  EXPECT_FALSE(scene.fields(0).visible());
  EXPECT_EQ(scene.fields(0).phase().kind(), v1::PhaseFunction::KIND_RAYLEIGH);
  EXPECT_EQ(scene.fields(0).scale(), 1.0F);
}

TEST(SessionsTest, CompletedSceneIsCompleteAlready) {
  FakeService service;
  const v1::Scene once = CreateWith(service, SmallScene()).scene();
  EXPECT_EQ(CreateWith(service, once).scene().SerializeAsString(), once.SerializeAsString());
}

TEST(SessionsTest, StormWithoutCondensateFramesTheDomain) {
  FakeService service;
  v1::Scene wanted = SmallScene();
  wanted.set_storm_id("clear");
  const v1::Scene scene = CreateWith(service, wanted).scene();
  EXPECT_EQ(scene.camera().orbit().target().x_m(), 0.0F);
  EXPECT_EQ(scene.camera().orbit().target().z_m(), 1250.0F);
  EXPECT_GT(scene.camera().orbit().distance_m(), 10000.0F);
}

TEST(SessionsTest, CompleteCameraNeedsNoRead) {
  FakeService service;
  v1::Scene scene = SmallScene();
  scene.mutable_camera()->mutable_orbit()->mutable_target();
  scene.mutable_camera()->mutable_orbit()->set_elevation_deg(4.0F);
  scene.mutable_camera()->mutable_orbit()->set_distance_m(50000.0F);
  CreateWith(service, scene);
  EXPECT_EQ(service.store->Reads(), 0);
}

TEST(SessionsTest, OtherCamerasAreFramedToo) {
  FakeService service;
  v1::Scene wanted = SmallScene();
  wanted.mutable_camera()->mutable_spotter()->set_azimuth_deg(0.0F);
  const v1::Scene spotted = CreateWith(service, wanted).scene();
  const v1::SpotterCamera& spotter = spotted.camera().spotter();
  EXPECT_EQ(spotter.azimuth_deg(), 0.0F);
  EXPECT_EQ(spotter.eye_height_m(), 1.7F);
  EXPECT_EQ(spotter.focal_length_mm(), 24.0F);
  // The spotter is due south of the one cell with condensate.
  EXPECT_NEAR(spotter.x_m(), -5500.0F, 0.01);
  // The cell's top is at 1.5 km; the spotter is 1.25 to 2.1 times as far away.
  EXPECT_LT(spotter.y_m(), -500.0F - 1875.0F + 1.0F);
  EXPECT_GT(spotter.y_m(), -500.0F - 3150.0F);
  EXPECT_GT(spotter.elevation_deg(), 0.0F);
  EXPECT_EQ(CreateWith(service, spotted).scene().SerializeAsString(), spotted.SerializeAsString());
  // If only one coordinate of the place is given, the server keeps it and chooses the other. The
  // spotter looks at the storm from there.
  wanted.mutable_camera()->mutable_spotter()->clear_azimuth_deg();
  wanted.mutable_camera()->mutable_spotter()->set_x_m(-4000.0F);
  wanted.mutable_camera()->mutable_spotter()->set_elevation_deg(3.0F);
  const v1::SpotterCamera beside = CreateWith(service, wanted).scene().camera().spotter();
  EXPECT_EQ(beside.x_m(), -4000.0F);
  EXPECT_EQ(beside.elevation_deg(), 3.0F);
  EXPECT_NEAR(std::tan(glm::radians(beside.azimuth_deg())),
              (-5500.0F + 4000.0F) / (-500.0F - beside.y_m()), 1e-3);
  // From a given place the spotter looks at the storm.
  wanted.mutable_camera()->mutable_spotter()->set_x_m(-50000.0F);
  wanted.mutable_camera()->mutable_spotter()->set_y_m(-500.0F);
  EXPECT_NEAR(CreateWith(service, wanted).scene().camera().spotter().azimuth_deg(), 90.0F, 0.01);

  wanted.set_storm_id("clear");
  wanted.mutable_camera()->mutable_spotter()->Clear();
  const v1::SpotterCamera clear = CreateWith(service, wanted).scene().camera().spotter();
  EXPECT_LT(clear.y_m(), -10000.0F);
  EXPECT_EQ(clear.azimuth_deg(), 20.0F);
  wanted.clear_storm_id();

  wanted.mutable_camera()->mutable_top_down();
  const v1::Scene map = CreateWith(service, wanted).scene();
  EXPECT_EQ(map.camera().top_down().x_m(), -5500.0F);
  EXPECT_EQ(map.camera().top_down().y_m(), -500.0F);
  EXPECT_GT(map.camera().top_down().width_m(), 1000.0F);
  EXPECT_EQ(CreateWith(service, map).scene().SerializeAsString(), map.SerializeAsString());
}

TEST(SessionsTest, AnIdealisedRunsSunIsSetByHand) {
  FakeService service;
  const v1::Sun sun = CreateWith(service, SmallScene()).scene().sun();
  EXPECT_EQ(sun.source(), v1::Sun::SOURCE_BY_HAND);
  EXPECT_EQ(sun.azimuth_deg(), 275.0F);
  EXPECT_EQ(sun.elevation_deg(), 18.0F);
}

TEST(SessionsTest, TheSunFollowsTheClockWhereAsked) {
  FakeService service;
  v1::Scene wanted = SmallScene();
  wanted.set_time_index(0);
  v1::Sun& sun = *wanted.mutable_sun();
  sun.set_source(v1::Sun::SOURCE_BY_TIME);
  sun.set_azimuth_deg(1.0F);
  // The clock is set to local noon at the equinox.
  sun.mutable_clock()->set_date_time("2013-03-20T12:00:00Z");
  sun.mutable_clock()->set_latitude_deg(0.0F);
  sun.mutable_clock()->set_longitude_deg(0.0F);
  const v1::Scene noon = CreateWith(service, wanted).scene();
  EXPECT_GT(noon.sun().elevation_deg(), 87.0F);
  EXPECT_EQ(CreateWith(service, noon).scene().SerializeAsString(), noon.SerializeAsString());
  // The sun moves with the storm's times, a quarter of a degree per minute.
  wanted.set_time_index(3);
  sun.mutable_clock()->set_date_time("2013-03-20T06:20:00Z");
  const float later_deg = CreateWith(service, wanted).scene().sun().elevation_deg();
  wanted.set_time_index(0);
  const float first_deg = CreateWith(service, wanted).scene().sun().elevation_deg();
  const double elapsed_min = service.store->Find("anvil")->times[3].elapsed_s / 60.0;
  EXPECT_GT(elapsed_min, 0.0);
  EXPECT_NEAR(later_deg - first_deg, elapsed_min / 4.0, 0.02);
  // By default the clock shows an afternoon in Oklahoma.
  sun.clear_clock();
  const v1::Sun open = CreateWith(service, wanted).scene().sun();
  EXPECT_EQ(open.clock().date_time(), "2013-05-20T20:00:00Z");
  EXPECT_GT(open.azimuth_deg(), 180.0F);
  EXPECT_GT(open.elevation_deg(), 45.0F);
}

TEST(SessionsTest, AClockWithoutADateIsRefused) {
  FakeService service;
  for (const std::string text : {"teatime", "2013-13-20T20:00:00Z", "2013-05-20T99:99:99Z",
                                 "2013-05-20T20:00:00+9999", "infinite-future"}) {
    v1::CreateSessionRequest request;
    v1::CreateSessionResponse response;
    request.mutable_scene()->mutable_sun()->mutable_clock()->set_date_time(text);
    const grpc::Status status = Call(service.stub(), &Stub::CreateSession, request, &response);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << text;
    EXPECT_THAT(status.error_message(), HasSubstr("scene.sun.clock.date_time is '" + text + "'"));
  }
}

TEST(SunMessages, ARealStormsSunFollowsItsTimeAndPlace) {
  storm_store::StormInfo storm;
  storm.times = {{"2013-05-20T19:00:00Z", 0.0}, {"2013-05-20T20:00:00Z", 3600.0}};
  storm.latitude_deg = 35.3;
  storm.longitude_deg = -97.6;
  v1::Sun sun;
  service::FillSunDefaults(sun, storm, 1);
  EXPECT_EQ(sun.source(), v1::Sun::SOURCE_BY_TIME);
  const physics::SunPosition expected = physics::SunPositionAt(1369080000.0, 35.3, -97.6);
  EXPECT_NEAR(sun.azimuth_deg(), expected.azimuth_deg, 1e-3);
  EXPECT_NEAR(sun.elevation_deg(), expected.elevation_deg, 1e-3);
  // Setting the sun's direction by hand stops it from following the clock.
  v1::Sun held;
  held.set_elevation_deg(10.0F);
  service::FillSunDefaults(held, storm, 1);
  EXPECT_EQ(held.source(), v1::Sun::SOURCE_BY_HAND);
  EXPECT_EQ(held.elevation_deg(), 10.0F);
}

// On a grid that is turned against true north, the azimuth of the sun counts from the grid's north.
// Here true north is 30 degrees to the left of it, as on a polar stereographic grid.
TEST(SunMessages, TheSunOfATurnedGridCountsFromTheGridsNorth) {
  storm_store::StormInfo storm;
  storm.times = {{"2013-05-20T20:00:00Z", 0.0}};
  storm.latitude_deg = 60.0;
  storm.longitude_deg = 40.0;
  storm.projection = "+proj=stere +lat_0=90 +lat_ts=60 +lon_0=10 +R=6370000";
  storm.true_north_deg = -30.0;
  v1::Sun sun;
  service::FillSunDefaults(sun, storm, 0);
  const physics::SunPosition expected = physics::SunPositionAt(1369080000.0, 60.0, 40.0);
  EXPECT_NEAR(sun.azimuth_deg(), expected.azimuth_deg - 30.0, 1e-3);
  EXPECT_NEAR(sun.elevation_deg(), expected.elevation_deg, 1e-3);
  // An azimuth stays within the schema's limits.
  storm.true_north_deg = 170.0;
  service::FillSunDefaults(sun, storm, 0);
  EXPECT_NEAR(sun.azimuth_deg(), std::fmod(expected.azimuth_deg + 170.0, 360.0), 1e-3);
}

TEST(SessionsTest, UnknownStormsAndTimesAreRefused) {
  FakeService service;
  v1::CreateSessionRequest request;
  v1::CreateSessionResponse response;
  request.mutable_scene()->set_storm_id("hurricane");
  EXPECT_EQ(Call(service.stub(), &Stub::CreateSession, request, &response).error_code(),
            grpc::StatusCode::NOT_FOUND);
  request.mutable_scene()->set_storm_id("anvil");
  request.mutable_scene()->set_time_index(9);
  const grpc::Status status = Call(service.stub(), &Stub::CreateSession, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(status.error_message(), "scene.time_index is 9; storm 'anvil' has times 0 to 3");
}

TEST(SessionsTest, RevisionsCount) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  EXPECT_EQ(service.Update(id, SmallScene()), 2U);
  EXPECT_EQ(service.Update(id, SmallScene()), 3U);
}

TEST(SessionsTest, UpdateThatFailsLeavesTheScene) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  v1::UpdateSceneRequest request;
  request.set_session_id(id);
  *request.mutable_scene() = SmallScene();
  request.mutable_scene()->set_time_index(7);
  v1::UpdateSceneResponse response;
  EXPECT_EQ(Call(service.stub(), &Stub::UpdateScene, request, &response).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  Watcher watcher(service.stub(), id);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  EXPECT_EQ(watcher.NewestFrame().scene_revision(), 1U);
}

TEST(SessionsTest, ClosedSessionIsNotFoundByEveryRpc) {
  FakeService service;
  const std::string id = service.Open(SmallScene());
  ASSERT_TRUE(Close(service, id).ok());
  const auto expect_gone = [&](const grpc::Status& status) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
    EXPECT_THAT(status.error_message(),
                HasSubstr("no session has the key '" + id.substr(0, 4) + "...'"));
  };
  expect_gone(Close(service, id));
  v1::UpdateSceneRequest update;
  update.set_session_id(id);
  v1::UpdateSceneResponse updated;
  expect_gone(Call(service.stub(), &Stub::UpdateScene, update, &updated));
  v1::AcknowledgeFrameRequest acknowledge;
  acknowledge.set_session_id(id);
  v1::AcknowledgeFrameResponse acknowledged;
  expect_gone(Call(service.stub(), &Stub::AcknowledgeFrame, acknowledge, &acknowledged));
  Watcher watcher(service.stub(), id);
  expect_gone(watcher.End());
}

TEST(SessionsTest, NoMoreThanTheMost) {
  service::ServerOptions options;
  options.sessions.max_sessions = 2;
  FakeService service(options);
  const std::string first = service.Open(SmallScene());
  service.Open(SmallScene());
  v1::CreateSessionResponse response;
  const grpc::Status status =
      Call(service.stub(), &Stub::CreateSession, v1::CreateSessionRequest(), &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(status.error_message(),
            "the server already has the maximum of 2 sessions; close one, or try again later");
  ASSERT_TRUE(Close(service, first).ok());
  service.Open(SmallScene());
}

TEST(SessionsTest, IdleSessionsExpireSoonerThanWatchedOnes) {
  RunningTime time;
  service::ServerOptions options = Patient(time);
  options.sessions.idle_timeout = std::chrono::hours(1);
  FakeService service(options);
  const std::string idle = service.Open(SmallScene());
  const std::string watched = service.Open(SmallScene());
  Watcher watcher(service.stub(), watched);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  time.Advance(std::chrono::hours(2));
  EXPECT_EQ(Close(service, idle).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_TRUE(Close(service, watched).ok());
}

TEST(SessionsTest, AWatchedSessionExpiresWhenNobodyDoesAnything) {
  RunningTime time;
  service::ServerOptions options = Patient(time);
  options.sessions.idle_timeout = std::chrono::hours(1);
  options.sessions.watched_idle_timeout = std::chrono::hours(5);
  FakeService service(options);
  const v1::CreateSessionResponse created = CreateWith(service, SmallScene());
  Interacting person(service.stub(), created.viewer_key());
  Watcher watcher(service.stub(), created.session_id());
  ASSERT_TRUE(person.AwaitFrame(1));
  // The session is in use while a viewer sends messages.
  for (int i = 0; i < 8; ++i) {
    time.Advance(std::chrono::hours(4));
    // A refusal is also an answer, so the session counts as in use.
    v1::InteractRequest steers;
    *steers.mutable_update_scene()->mutable_scene() = SmallScene();
    EXPECT_EQ(person.AnswerCode(person.Send(steers)), grpc::StatusCode::PERMISSION_DENIED);
  }
  for (const auto& message : person.All()) EXPECT_FALSE(message.has_end());
  time.Advance(std::chrono::hours(5));
  ASSERT_TRUE(person.Await([](const auto& messages) { return messages.back().has_end(); }));
  const grpc::Status end = person.End();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(ReasonOf(end), "SESSION_EXPIRED");
  EXPECT_EQ(end.error_message(), "the session has expired; create a new one");
  const auto messages = person.All();
  ASSERT_TRUE(messages.back().has_end());
  EXPECT_EQ(messages.back().end().reason(), v1::End::REASON_EXPIRED);
  EXPECT_FALSE(messages.back().end().has_retry_after_ms()) << "nothing to come back to";
  EXPECT_EQ(ReasonOf(watcher.End()), "SESSION_EXPIRED");
  EXPECT_EQ(Close(service, created.session_id()).error_code(), grpc::StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace thunderhead::testing
