// Tests of ProbeRay and GetStormMap on fakes. "anvil" has one cell of cloud with 1 g/m3, with its
// middle at (-5500, -500, 1250) m, in cells of 1 km x 1 km x 500 m.
#include <chrono>
#include <cmath>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"

namespace thunderhead::testing {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using Stub = v1::ThunderheadService::Stub;

// Extinction of 1 g/m3 of droplets with a radius of 10 um (the observed constant).
constexpr double kCellExtinction_per_m = 0.001 * 3.0 / (2.0 * 1000.0 * 1e-5);

grpc::Status Probe(FakeService& service, const v1::ProbeRayRequest& request,
                   v1::ProbeRayResponse* response) {
  response->Clear();
  return Call(service.stub(), &Stub::ProbeRay, request, response);
}

v1::ProbeRayResponse Probed(FakeService& service, const v1::ProbeRayRequest& request) {
  v1::ProbeRayResponse response;
  const grpc::Status status = Probe(service, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response;
}

grpc::Status Map(FakeService& service, const v1::GetStormMapRequest& request,
                 v1::GetStormMapResponse* response) {
  response->Clear();
  return Call(service.stub(), &Stub::GetStormMap, request, response);
}

v1::GetStormMapResponse Mapped(FakeService& service, const v1::GetStormMapRequest& request) {
  v1::GetStormMapResponse response;
  const grpc::Status status = Map(service, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response;
}

void SetRay(double x_m, double y_m, double z_m, double dx, double dy, double dz,
            v1::ProbeRayRequest& request) {
  v1::Ray& ray = *request.mutable_ray();
  ray.mutable_origin()->set_x_m(x_m);
  ray.mutable_origin()->set_y_m(y_m);
  ray.mutable_origin()->set_z_m(z_m);
  ray.mutable_direction()->set_x(static_cast<float>(dx));
  ray.mutable_direction()->set_y(static_cast<float>(dy));
  ray.mutable_direction()->set_z(static_cast<float>(dz));
}

// Returns a scene with a camera straight above the cell.
v1::Scene SceneFromAbove() {
  v1::Scene scene = SmallScene();
  v1::TopDownCamera& camera = *scene.mutable_camera()->mutable_top_down();
  camera.set_x_m(-5500.0F);
  camera.set_y_m(-500.0F);
  camera.set_width_m(4000.0F);
  return scene;
}

// Puts "anvil" on a Mercator map with 40 N 100 W in its middle.
void GiveAPlace(FakeService& service) {
  service.store->Become("anvil", [](storm_store::StormInfo& storm) {
    storm.latitude_deg = 40.0;
    storm.longitude_deg = -100.0;
    storm.projection =
        "+proj=merc +lat_ts=40 +lon_0=-100 +x_0=0 +y_0=0 +R=6370000 +units=m +no_defs";
  });
}

TEST(ProbeTest, ARayDownThroughTheCellHasItsTent) {
  FakeService service;
  v1::ProbeRayRequest request;
  *request.mutable_scene() = SceneFromAbove();
  request.set_samples(9);
  const v1::ProbeRayResponse probe = Probed(service, request);
  EXPECT_EQ(probe.storm_id(), "anvil");
  EXPECT_EQ(probe.time_index(), SmallScene().has_time_index() ? SmallScene().time_index() : 3U);
  EXPECT_EQ(probe.scene_revision(), 0U);
  EXPECT_EQ(probe.ray().origin().x_m(), -5500.0);
  EXPECT_EQ(probe.ray().direction().z(), -1.0F);
  // The extinction along the ray is a triangle 1 km wide.
  EXPECT_NEAR(probe.optical_depth(), kCellExtinction_per_m * 500.0, 1e-3);
  EXPECT_EQ(probe.first_cloud_depth(), 0.1F);
  // At depth s below the top of the triangle, the optical depth is s^2 / (2 * 500 m) times the
  // cell's extinction.
  const double first_m = std::sqrt(0.1 * 2.0 * 500.0 / kCellExtinction_per_m);
  EXPECT_NEAR(probe.first_cloud().height_m(), 1750.0 - first_m, 0.1);
  EXPECT_NEAR(probe.first_cloud().height_above_ground_m(), 1750.0 - first_m, 0.1);
  EXPECT_NEAR(probe.first_cloud().position().x_m(), -5500.0, 1e-3);
  EXPECT_NEAR(probe.depth_one().height_m(), 1750.0 - first_m * std::sqrt(10.0), 0.1);
  EXPECT_FALSE(probe.first_cloud().has_earth());
  EXPECT_EQ(probe.ground().height_above_ground_m(), 0.0);
  EXPECT_NEAR(probe.ground().height_m(), 0.0, 1e-9);
  EXPECT_EQ(probe.seen(), v1::ProbeRayResponse::SEEN_CLOUD);
  EXPECT_NEAR(probe.seen_place().height_m(), 1750.0 - first_m * std::sqrt(std::log(2.0) / 0.1),
              1.0);
  // The samples run from the top of the domain to the ground, every 312.5 m.
  ASSERT_EQ(probe.distances_m_size(), 9);
  EXPECT_NEAR(probe.heights_m(0), 2500.0F, 1e-3F);
  EXPECT_NEAR(probe.heights_m(8), 0.0F, 1.0F);
  ASSERT_EQ(probe.fields_size(), 2);
  const v1::FieldAlongRay& cloud = probe.fields(0);
  EXPECT_EQ(cloud.hydrometeor(), v1::HYDROMETEOR_CLOUD);
  EXPECT_EQ(cloud.variable(), "QCLOUD");
  EXPECT_EQ(cloud.units(), "kg m-3") << "the fake has no air";
  EXPECT_NEAR(cloud.values(4), 1e-3F, 2e-6F);
  EXPECT_NEAR(cloud.values(3), 1e-3F * (1.0F - 312.5F / 500.0F), 2e-6F);
  EXPECT_EQ(cloud.values(2), 0.0F);
  EXPECT_NEAR(probe.extinctions_per_m(4), kCellExtinction_per_m, 1e-4);
  EXPECT_NEAR(cloud.maximum(), 1e-3F, 1e-9F);
  EXPECT_NEAR(cloud.maximum_kg_per_m3(), 1e-3F, 1e-9F);
  EXPECT_NEAR(cloud.maximum_place().height_m(), 1250.0, 1e-3);
  EXPECT_NEAR(cloud.path_kg_per_m2(), 1e-3 * 500.0, 1e-6);
  EXPECT_NEAR(cloud.optical_depth(), probe.optical_depth(), 1e-9);
  const v1::FieldAlongRay& rain = probe.fields(1);
  EXPECT_EQ(rain.values_size(), 0);
  EXPECT_FALSE(rain.has_maximum_place());
}

TEST(ProbeTest, AStormWithAProjectionHasPlacesOnEarth) {
  FakeService service;
  GiveAPlace(service);
  v1::ProbeRayRequest request;
  *request.mutable_scene() = SceneFromAbove();
  const v1::ProbeRayResponse probe = Probed(service, request);
  constexpr double kMetresADegree = 6370000.0 * 3.14159265358979 / 180.0;
  EXPECT_NEAR(probe.first_cloud().earth().latitude_deg(), 40.0 - 500.0 / kMetresADegree, 1e-5);
  EXPECT_NEAR(probe.first_cloud().earth().longitude_deg(),
              -100.0 - 5500.0 / kMetresADegree / std::cos(40.0 * 3.14159265358979 / 180.0), 1e-5);
  EXPECT_TRUE(probe.ground().has_earth());
  EXPECT_TRUE(probe.fields(0).maximum_place().has_earth());
}

TEST(ProbeTest, PointsOfThePictureAndAllKindsOfCamerasCount) {
  FakeService service;
  v1::ProbeRayRequest request;
  *request.mutable_scene() = SceneFromAbove();
  // The picture of 64 x 36 pixels is 4000 m wide, so its upper right corner is 2000 m east and 1125
  // m north of its middle.
  request.mutable_point()->set_x(1.0F);
  request.mutable_point()->set_y(1.0F);
  v1::ProbeRayResponse probe = Probed(service, request);
  EXPECT_NEAR(probe.ray().origin().x_m(), -3500.0, 1e-2);
  EXPECT_NEAR(probe.ray().origin().y_m(), 625.0, 1e-2);
  EXPECT_EQ(probe.seen(), v1::ProbeRayResponse::SEEN_GROUND);
  EXPECT_NEAR(probe.seen_place().position().x_m(), -3500.0, 1e-2);
  EXPECT_FALSE(probe.has_first_cloud());
  // Uses another camera than the scene's.
  v1::SpotterCamera& spotter = *request.mutable_camera()->mutable_spotter();
  spotter.set_x_m(-5500.0F);
  spotter.set_y_m(-9000.0F);
  spotter.set_azimuth_deg(0.0F);
  spotter.set_elevation_deg(8.4F);
  request.clear_point();
  probe = Probed(service, request);
  EXPECT_NEAR(probe.ray().origin().z_m(), 1.7, 10.0) << "a spotter's eye";
  EXPECT_EQ(probe.seen(), v1::ProbeRayResponse::SEEN_CLOUD);
  EXPECT_GT(probe.optical_depth(), 10.0);
  EXPECT_FALSE(probe.has_ground());
  // An orbit camera without values is chosen by the server. It shows the storm's only cloud cell in
  // the middle of the picture.
  request.mutable_camera()->mutable_orbit();
  probe = Probed(service, request);
  EXPECT_GT(probe.optical_depth(), 10.0);
  // A spotter who looks away from the cell sees nothing of it.
  request.clear_point();
  v1::SpotterCamera& away = *request.mutable_camera()->mutable_spotter();
  away.set_x_m(-5500.0F);
  away.set_y_m(-9000.0F);
  away.set_azimuth_deg(180.0F);
  away.set_elevation_deg(8.4F);
  probe = Probed(service, request);
  EXPECT_EQ(probe.seen(), v1::ProbeRayResponse::SEEN_SKY);
  EXPECT_FALSE(probe.has_seen_place());
}

TEST(ProbeTest, ASessionIsProbedByEitherKeyInItsNewestScene) {
  FakeService service;
  v1::CreateSessionRequest create;
  *create.mutable_scene() = SceneFromAbove();
  v1::CreateSessionResponse created;
  ASSERT_TRUE(Call(service.stub(), &Stub::CreateSession, create, &created).ok());
  v1::Scene hidden = SceneFromAbove();
  v1::FieldParameters& cloud = *hidden.add_fields();
  cloud.set_hydrometeor(v1::HYDROMETEOR_CLOUD);
  cloud.set_visible(false);
  hidden.set_time_index(1);
  for (const std::string& key : {created.session_id(), created.viewer_key()}) {
    v1::ProbeRayRequest request;
    request.set_session_id(key);
    const v1::ProbeRayResponse probe = Probed(service, request);
    EXPECT_EQ(probe.scene_revision(), created.scene_revision());
    EXPECT_GT(probe.optical_depth(), 10.0);
  }
  const std::uint64_t revision = service.Update(created.session_id(), hidden);
  v1::ProbeRayRequest request;
  request.set_session_id(created.viewer_key());
  const v1::ProbeRayResponse probe = Probed(service, request);
  EXPECT_EQ(probe.scene_revision(), revision);
  EXPECT_EQ(probe.time_index(), 1U);
  EXPECT_EQ(probe.optical_depth(), 0.0) << "hidden";
  EXPECT_NEAR(probe.fields(0).path_kg_per_m2(), 0.5, 1e-3) << "and yet there";
  request.set_session_id("nobody's");
  v1::ProbeRayResponse none;
  EXPECT_EQ(Probe(service, request, &none).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST(ProbeTest, ARayThatMissesTheDomainHasNoSamples) {
  FakeService service;
  v1::ProbeRayRequest request;
  *request.mutable_scene() = SceneFromAbove();
  SetRay(0.0, 0.0, 9000.0, 0.0, 0.0, 5.0, request);
  const v1::ProbeRayResponse probe = Probed(service, request);
  EXPECT_EQ(probe.ray().direction().z(), 1.0F) << "of length 1";
  EXPECT_EQ(probe.distances_m_size(), 0);
  EXPECT_EQ(probe.fields_size(), 2);
  EXPECT_EQ(probe.fields(0).values_size(), 0);
  EXPECT_EQ(probe.seen(), v1::ProbeRayResponse::SEEN_SKY);
  EXPECT_FALSE(probe.has_ground());
}

TEST(ProbeTest, SamplesAreAsManyAsAskedFor) {
  FakeService service;
  v1::ProbeRayRequest request;
  *request.mutable_scene() = SceneFromAbove();
  EXPECT_EQ(Probed(service, request).distances_m_size(), 128);
  for (const std::uint32_t samples : {0U, 1U, 1024U}) {
    request.set_samples(samples);
    const v1::ProbeRayResponse probe = Probed(service, request);
    EXPECT_EQ(probe.distances_m_size(), static_cast<int>(samples));
    EXPECT_EQ(probe.fields(0).values_size(), static_cast<int>(samples));
    EXPECT_NEAR(probe.fields(0).maximum(), 1e-3F, 1e-9F) << "whatever the samples";
  }
  request.set_first_cloud_depth(2.0F);
  const v1::ProbeRayResponse probe = Probed(service, request);
  EXPECT_EQ(probe.first_cloud_depth(), 2.0F);
  EXPECT_LT(probe.first_cloud().height_m(), probe.depth_one().height_m());
}

TEST(ProbeTest, BadRequestsNameTheField) {
  FakeService service;
  v1::ProbeRayResponse response;
  const auto expect = [&](const v1::ProbeRayRequest& request, const std::string& message) {
    const grpc::Status status = Probe(service, request, &response);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << message;
    EXPECT_THAT(status.error_message(), HasSubstr(message));
  };
  v1::ProbeRayRequest request;
  request.set_samples(1025);
  expect(request, "samples is 1025; it must be between 0 and 1024");
  request.Clear();
  request.mutable_point()->set_x(1.5F);
  expect(request, "point.x is 1.5; it must be between -1 and 1");
  request.mutable_point()->set_x(std::nanf(""));
  expect(request, "point.x is nan");
  request.Clear();
  SetRay(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, request);
  expect(request, "ray.direction has length 0");
  SetRay(1e9, 0.0, 0.0, 0.0, 0.0, 1.0, request);
  expect(request, "ray.origin.x_m is 1e+09");
  request.Clear();
  request.set_first_cloud_depth(0.0F);
  expect(request, "first_cloud_depth is 0");
  request.Clear();
  request.mutable_scene()->set_time_index(4);
  expect(request, "scene.time_index is 4; storm 'anvil' has times 0 to 3");
  request.Clear();
  request.mutable_camera()->mutable_orbit()->set_field_of_view_deg(500.0F);
  expect(request, "camera.orbit.field_of_view_deg is 500");
  request.Clear();
  request.mutable_scene()->set_storm_id("hurricane");
  EXPECT_EQ(Probe(service, request, &response).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST(ProbeTest, OtherCallsGoOnWhileTheStormIsRead) {
  FakeService service;
  service.store->reading.Close();
  v1::ProbeRayRequest request;
  *request.mutable_scene() = SceneFromAbove();
  grpc::Status cancelled;
  grpc::ClientContext context;
  std::thread prober([&] {
    v1::ProbeRayResponse response;
    cancelled = service.stub().ProbeRay(&context, request, &response);
  });
  EXPECT_TRUE(service.store->reading.AwaitWaiting(1));
  v1::ListStormsResponse list;
  EXPECT_TRUE(Call(service.stub(), &Stub::ListStorms, v1::ListStormsRequest(), &list).ok());
  context.TryCancel();
  prober.join();
  EXPECT_EQ(cancelled.error_code(), grpc::StatusCode::CANCELLED) << "it still waits";
  service.store->reading.Open();
  EXPECT_GT(Probed(service, request).optical_depth(), 10.0);
}

TEST(ProbeTest, AStormThatCannotBeReadSaysSo) {
  FakeService service;
  service.store->FailAt(1, absl::DataLossError("wrfout_1: QRAIN is truncated; copy it again"));
  v1::ProbeRayRequest request;
  *request.mutable_scene() = SceneFromAbove();
  request.mutable_scene()->set_time_index(1);
  v1::ProbeRayResponse response;
  const grpc::Status status = Probe(service, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_THAT(status.error_message(), HasSubstr("QRAIN is truncated"));
  v1::GetStormMapRequest map;
  map.set_time_index(1);
  v1::GetStormMapResponse mapped;
  EXPECT_EQ(Map(service, map, &mapped).error_code(), grpc::StatusCode::DATA_LOSS);
}

TEST(StormMapTest, TheMapIsNumbersWithItsLegend) {
  FakeService service;
  GiveAPlace(service);
  v1::GetStormMapRequest request;
  request.set_time_index(2);
  request.set_with_terrain(true);
  const v1::GetStormMapResponse map = Mapped(service, request);
  EXPECT_EQ(map.storm_id(), "anvil");
  EXPECT_EQ(map.time_index(), 2U);
  ASSERT_EQ(map.width_px(), 20U);
  ASSERT_EQ(map.height_px(), 10U);
  ASSERT_EQ(map.values_size(), 200);
  EXPECT_NEAR(map.values(4 * 20 + 4), 1e-3F * 500.0F, 1e-6F);
  EXPECT_EQ(map.minimum(), map.maximum()) << "of the only one above 0";
  EXPECT_NEAR(map.maximum(), 0.5F, 1e-6F);
  EXPECT_EQ(map.units(), "kg m-2");
  EXPECT_THAT(map.fields(), ElementsAre(v1::HYDROMETEOR_CLOUD, v1::HYDROMETEOR_RAIN));
  EXPECT_EQ(map.low().x_m(), -10000.0F);
  EXPECT_EQ(map.high().y_m(), 5000.0F);
  EXPECT_EQ(map.high().z_m(), 2500.0F);
  ASSERT_EQ(map.corners_size(), 4);
  EXPECT_LT(map.corners(0).latitude_deg(), 40.0);
  EXPECT_LT(map.corners(0).longitude_deg(), -100.0);
  EXPECT_GT(map.corners(1).longitude_deg(), -100.0);
  EXPECT_GT(map.corners(2).latitude_deg(), 40.0);
  EXPECT_LT(map.corners(3).longitude_deg(), -100.0);
  EXPECT_EQ(map.middle().latitude_deg(), 40.0);
  EXPECT_THAT(map.projection(), HasSubstr("+proj=merc"));
  EXPECT_THAT(map.terrain_height_m(), SizeIs(200));
  EXPECT_THAT(map.terrain_height_m(), Each(0.0F));
  ASSERT_EQ(map.maxima_size(), 2);
  const v1::FieldMaximum& cloud = map.maxima(0);
  EXPECT_EQ(cloud.hydrometeor(), v1::HYDROMETEOR_CLOUD);
  EXPECT_EQ(cloud.value(), 1e-3F);
  EXPECT_EQ(cloud.units(), "kg m-3");
  EXPECT_EQ(cloud.position().x_m(), -5500.0F);
  EXPECT_EQ(cloud.position().z_m(), 1250.0F);
  EXPECT_EQ(cloud.height_above_ground_m(), 1250.0F);
  EXPECT_TRUE(cloud.has_earth());
  EXPECT_NEAR(cloud.column(), 0.5F, 1e-6F);
  EXPECT_EQ(cloud.column_position().y_m(), -500.0F);
  EXPECT_FALSE(map.maxima(1).has_position());
}

TEST(StormMapTest, PlacesAreSentAsATableIfAsked) {
  FakeService service;
  GiveAPlace(service);
  v1::GetStormMapRequest request;
  EXPECT_FALSE(Mapped(service, request).has_places());
  request.set_with_places(true);
  const v1::PlaceTable table = Mapped(service, request).places();
  const auto nodes = static_cast<int>(table.nodes());
  ASSERT_EQ(table.x_m_size(), nodes * nodes);
  ASSERT_EQ(table.y_m_size(), nodes * nodes);
  // Checks the table's middle, and the middle of its northern side, whose y follows from the
  // latitude by Mercator's formula.
  const int middle = nodes / 2 * nodes + nodes / 2;
  EXPECT_NEAR(table.x_m(middle), 0.0F, 0.1F);
  EXPECT_NEAR(table.y_m(middle), 0.0F, 0.1F);
  const auto stretched = [](double degrees) {
    return std::log(std::tan((45.0 + degrees / 2.0) * 3.14159265358979 / 180.0));
  };
  const double y_m = 6370000.0 * std::cos(40.0 * 3.14159265358979 / 180.0) *
                     (stretched(40.0 + table.reach_deg()) - stretched(40.0));
  EXPECT_NEAR(table.y_m((nodes - 1) * nodes + nodes / 2), y_m, 0.1);
  EXPECT_GT(y_m, 1.8 * 20'000.0) << "the domain is 20 km wide";
  service.store->Become("anvil", [](storm_store::StormInfo& storm) { storm.projection.clear(); });
  EXPECT_FALSE(Mapped(service, request).has_places());
}

TEST(StormMapTest, SizeAndFieldsAreChosen) {
  FakeService service;
  v1::GetStormMapRequest request;
  request.set_max_size_px(5);
  v1::GetStormMapResponse map = Mapped(service, request);
  EXPECT_EQ(map.width_px(), 5U);
  EXPECT_EQ(map.height_px(), 3U);
  EXPECT_EQ(map.values_size(), 15);
  EXPECT_EQ(map.terrain_height_m_size(), 0);
  EXPECT_EQ(map.corners_size(), 0) << "an idealised run";
  EXPECT_FALSE(map.has_middle());
  request.add_fields(v1::HYDROMETEOR_RAIN);
  map = Mapped(service, request);
  EXPECT_THAT(map.fields(), ElementsAre(v1::HYDROMETEOR_RAIN));
  EXPECT_EQ(map.maximum(), 0.0F);
  EXPECT_EQ(map.minimum(), 0.0F);
  EXPECT_EQ(map.maxima_size(), 2) << "of every field";
  request.set_storm_id("clear");
  map = Mapped(service, request);
  EXPECT_EQ(map.maximum(), 0.0F);
}

TEST(StormMapTest, BadRequestsNameTheField) {
  FakeService service;
  v1::GetStormMapResponse response;
  const auto expect = [&](const v1::GetStormMapRequest& request, const std::string& message) {
    const grpc::Status status = Map(service, request, &response);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << message;
    EXPECT_THAT(status.error_message(), HasSubstr(message));
  };
  v1::GetStormMapRequest request;
  request.set_max_size_px(513);
  expect(request, "max_size_px is 513; it must be between 1 and 512");
  request.Clear();
  request.set_time_index(4);
  expect(request, "time_index is 4; storm 'anvil' has times 0 to 3");
  request.Clear();
  request.add_fields(v1::HYDROMETEOR_CLOUD);
  request.add_fields(v1::HYDROMETEOR_HAIL);
  expect(request,
         "fields[1] is HYDROMETEOR_HAIL, which storm 'anvil' does not have; it has "
         "HYDROMETEOR_CLOUD, HYDROMETEOR_RAIN");
  request.Clear();
  request.set_storm_id("hurricane");
  EXPECT_EQ(Map(service, request, &response).error_code(), grpc::StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace thunderhead::testing
