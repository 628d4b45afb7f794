// Tests of the descriptions of the server and its storms.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

grpc::Status Describe(FakeService& service, const std::string& id, std::uint32_t time_index,
                      v1::StormDescription* storm) {
  v1::DescribeStormRequest request;
  request.set_storm_id(id);
  request.set_time_index(time_index);
  v1::DescribeStormResponse response;
  const grpc::Status status = Call(service.stub(), &Stub::DescribeStorm, request, &response);
  *storm = response.storm();
  return status;
}

void ExpectOutOfMemory(const grpc::Status& status) {
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr("not enough memory"));
}

TEST(StormsTest, ServerInfoSaysWhatItRunsOn) {
  FakeService service;
  v1::GetServerInfoResponse info;
  ASSERT_TRUE(Call(service.stub(), &Stub::GetServerInfo, v1::GetServerInfoRequest(), &info).ok());
  EXPECT_EQ(info.gl_renderer(), "fake renderer");
  EXPECT_EQ(info.gl_version(), "4.5 fake");
  EXPECT_EQ(info.device(), "software");
  EXPECT_EQ(info.max_sessions(), 64U);
  EXPECT_THAT(info.version(), ::testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
}

TEST(StormsTest, StormsAreListedInOrder) {
  FakeService service;
  v1::ListStormsResponse list;
  ASSERT_TRUE(Call(service.stub(), &Stub::ListStorms, v1::ListStormsRequest(), &list).ok());
  ASSERT_EQ(list.storms_size(), 2);
  EXPECT_EQ(list.storms(0).id(), "anvil");
  EXPECT_EQ(list.storms(0).title(), "A storm called anvil");
  EXPECT_EQ(list.storms(0).time_count(), 4U);
  EXPECT_EQ(list.storms(1).id(), "clear");
}

TEST(StormsTest, AStormThatIsNotFoundYetIsToBeAskedForAgain) {
  FakeService service;
  service.store->searching = true;
  v1::StormDescription storm;
  EXPECT_TRUE(Describe(service, "anvil", 2, &storm).ok());
  const grpc::Status early = Describe(service, "squall", 0, &storm);
  EXPECT_EQ(early.error_code(), grpc::StatusCode::UNAVAILABLE) << early.error_message();
  EXPECT_THAT(early.error_message(), HasSubstr("still searches"));
  EXPECT_TRUE(Describe(service, "", 0, &storm).ok()) << "any storm will do";
  service.store->searching = false;
  EXPECT_EQ(Describe(service, "squall", 0, &storm).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST(StormsTest, DescriptionHoldsGridTimesFieldsAndDefaults) {
  FakeService service;
  v1::StormDescription storm;
  ASSERT_TRUE(Describe(service, "anvil", 2, &storm).ok());
  EXPECT_EQ(storm.id(), "anvil");
  EXPECT_EQ(storm.time_index(), 2U);
  ASSERT_EQ(storm.times_size(), 4);
  EXPECT_EQ(storm.times(3).valid_time(), "0001-01-01T00:40:00Z");
  EXPECT_EQ(storm.times(3).elapsed_s(), 1800.0);
  EXPECT_EQ(storm.grid().nx(), 20U);
  EXPECT_EQ(storm.grid().dz_m(), 500.0);
  EXPECT_EQ(storm.grid().low().x_m(), -10000.0F);
  EXPECT_EQ(storm.grid().high().y_m(), 5000.0F);
  EXPECT_FALSE(storm.has_latitude_deg());
  EXPECT_EQ(storm.turbulence_source(), v1::StormDescription::TURBULENCE_SOURCE_ENERGY);
  EXPECT_EQ(storm.turbulence_variable(), "QKE");
  EXPECT_EQ(storm.steering_east_m_per_s(), 12.5F);
  EXPECT_EQ(storm.steering_north_m_per_s(), -4.0F);
  ASSERT_EQ(storm.fields_size(), 2);
  const v1::FieldDescription& cloud = storm.fields(0);
  EXPECT_EQ(cloud.hydrometeor(), v1::HYDROMETEOR_CLOUD);
  EXPECT_EQ(cloud.variable(), "QCLOUD");
  EXPECT_EQ(cloud.minimum_kg_per_kg(), -1e-13F);
  EXPECT_EQ(cloud.maximum_kg_per_kg(), 2e-3F);
  EXPECT_EQ(cloud.units(), "kg kg-1");
  EXPECT_EQ(cloud.maximum(), 2e-3F);
  EXPECT_EQ(cloud.mean_water_path_kg_per_m2(), 0.25);
  EXPECT_EQ(cloud.maximum_water_path_kg_per_m2(), 7.5);
  EXPECT_EQ(cloud.negative_cells(), 3U);
  EXPECT_EQ(cloud.missing_cells(), 1U);
  EXPECT_FALSE(cloud.defaults().has_radius_m());
  EXPECT_EQ(cloud.size_origin(), v1::FieldDescription::SIZE_ORIGIN_OBSERVED);
  EXPECT_EQ(cloud.mean_radius_m(), 1e-5F);
  EXPECT_EQ(cloud.papers_radius_m(), 1e-5F);
  EXPECT_EQ(storm.fields(1).size_origin(), v1::FieldDescription::SIZE_ORIGIN_NUMBER);
  EXPECT_EQ(storm.fields(1).size_variable(), "QNRAIN");
  EXPECT_EQ(storm.fields(1).papers_radius_m(), 1e-3F);
  EXPECT_EQ(storm.fields(1).mean_radius_m(), 0.0F) << "there are no drops";
  EXPECT_TRUE(cloud.defaults().visible());
  EXPECT_EQ(cloud.defaults().scale(), 1.0F);
  EXPECT_EQ(cloud.defaults().detail().share(), 1.0F);
  EXPECT_EQ(cloud.defaults().detail().wavelength_m(),
            3.0F * static_cast<float>(storm.grid().dx_m()));
  EXPECT_EQ(storm.fields(1).defaults().density_kg_per_m3(), 1000.0F);
  // The bounds are those of cell (4, 4, 2), in cells of 1 km x 1 km x 500 m counted from (-10 km,
  // -5 km, 0).
  EXPECT_EQ(storm.condensate_low().x_m(), -6000.0F);
  EXPECT_EQ(storm.condensate_low().z_m(), 1000.0F);
  EXPECT_EQ(storm.condensate_high().y_m(), 0.0F);
}

TEST(StormsTest, StormWithoutCondensateHasNoCondensateBox) {
  FakeService service;
  v1::StormDescription storm;
  ASSERT_TRUE(Describe(service, "clear", 0, &storm).ok());
  EXPECT_FALSE(storm.has_condensate_low());
  EXPECT_EQ(storm.fields_size(), 2);
}

TEST(StormsTest, UnknownStormIsNotFoundAndNamesThoseThereAre) {
  FakeService service;
  v1::StormDescription storm;
  const grpc::Status status = Describe(service, "hurricane", 0, &storm);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(status.error_message(), "no storm has the id 'hurricane'; the server has anvil, clear");
}

TEST(StormsTest, TimeBeyondTheLastNamesTheRange) {
  FakeService service;
  v1::StormDescription storm;
  const grpc::Status status = Describe(service, "anvil", 4, &storm);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(status.error_message(), "time_index is 4; storm 'anvil' has times 0 to 3");
}

TEST(StormsTest, ReadErrorComesBackWithItsText) {
  FakeService service;
  service.store->FailAt(1, absl::DataLossError("wrfout_1: QRAIN is truncated; copy it again"));
  v1::StormDescription storm;
  const grpc::Status status = Describe(service, "anvil", 1, &storm);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_THAT(status.error_message(), HasSubstr("QRAIN is truncated"));
}

TEST(StormsTest, ACallWithoutMemoryIsAnsweredAndTheServerStops) {
  FakeService service;
  service.store->without_memory = true;
  v1::DescribeStormRequest describe;
  describe.set_storm_id("anvil");
  v1::DescribeStormResponse described;
  ExpectOutOfMemory(Call(service.stub(), &Stub::DescribeStorm, describe, &described));
  v1::GetStormMapRequest map;
  map.set_storm_id("anvil");
  v1::GetStormMapResponse mapped;
  ExpectOutOfMemory(Call(service.stub(), &Stub::GetStormMap, map, &mapped));
  v1::ProbeRayRequest probe;
  *probe.mutable_scene() = SmallScene();
  probe.mutable_point()->set_x(0.5F);
  probe.mutable_point()->set_y(0.5F);
  v1::ProbeRayResponse probed;
  ExpectOutOfMemory(Call(service.stub(), &Stub::ProbeRay, probe, &probed));
  // The shutdown would wait for calls that never finish.
  service.server().Shutdown();
}

TEST(StormsTest, OtherCallsGoOnDuringALongRead) {
  FakeService service;
  service.store->reading.Close();
  v1::StormDescription storm;
  grpc::Status described;
  std::thread reader([&] { described = Describe(service, "anvil", 0, &storm); });
  EXPECT_TRUE(service.store->reading.AwaitWaiting(1));
  v1::ListStormsResponse list;
  EXPECT_TRUE(Call(service.stub(), &Stub::ListStorms, v1::ListStormsRequest(), &list).ok());
  service.store->reading.Open();
  reader.join();
  EXPECT_TRUE(described.ok()) << described.error_message();
}

}  // namespace
}  // namespace thunderhead::testing
