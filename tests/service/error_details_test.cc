// Tests of machine-readable errors: google.rpc's details in grpc-status-details-bin, for each class
// of error.
#include <map>
#include <ostream>
#include <thread>

#include "clouds/presets.h"
#include "gmock/gmock.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"
#include "rpc_port/status_table.h"
#include "service/engine/cloud_store.h"
#include "tests/service/fake_service.h"
#include "tests/support/decoded_details.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;
using ::testing::StartsWith;
using Stub = v1::ThunderheadService::Stub;

// Expects an error that names no field.
void ExpectRefusal(const grpc::Status& refusal, grpc::StatusCode code, const std::string& reason) {
  EXPECT_EQ(refusal.error_code(), code) << refusal.error_message();
  const Decoded decoded = Decode(refusal);
  EXPECT_EQ(decoded.reason, reason) << refusal.error_message();
  EXPECT_FALSE(decoded.bad_request);
  const bool may_retry =
      code == grpc::StatusCode::RESOURCE_EXHAUSTED || code == grpc::StatusCode::UNAVAILABLE;
  EXPECT_EQ(decoded.retry_s > 0.0, may_retry) << decoded.retry_s;
}

struct DetailsCase {
  const char* scene;
  const char* field;
  const char* description;
  const char* reason;
  std::map<std::string, std::string> metadata = {};
};

void PrintTo(const DetailsCase& wrong, std::ostream* out) { *out << wrong.scene; }

class WrongFieldTest : public ::testing::TestWithParam<DetailsCase> {};

TEST_P(WrongFieldTest, IsInTheDetails) {
  FakeService service;
  v1::CreateSessionRequest request;
  ASSERT_TRUE(
      google::protobuf::util::JsonStringToMessage(GetParam().scene, request.mutable_scene()).ok());
  v1::CreateSessionResponse response;
  const grpc::Status refusal = Call(service.stub(), &Stub::CreateSession, request, &response);
  EXPECT_EQ(refusal.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  const Decoded decoded = Decode(refusal);
  EXPECT_EQ(decoded.field, GetParam().field);
  EXPECT_EQ(decoded.description, GetParam().description);
  EXPECT_EQ(decoded.reason, GetParam().reason);
  EXPECT_EQ(decoded.metadata, GetParam().metadata);
  EXPECT_LT(decoded.retry_s, 0.0) << "the same again is as wrong";
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, WrongFieldTest,
    ::testing::Values(
        DetailsCase{R"({"fields": [{"hydrometeor": 1}, {"hydrometeor": 2, "radiusM": 5}]})",
                    "scene.fields[1].radius_m",
                    "is 5; it must be between 1e-07 and 0.1 m",
                    "VALUE_OUT_OF_RANGE",
                    {{"minimum", "1e-07"}, {"maximum", "0.1"}, {"unit", "m"}}},
        DetailsCase{
            R"({"fields": [{"hydrometeor": 77}]})",
            "scene.fields[0].hydrometeor",
            "is 77; it must be one of HYDROMETEOR_UNSPECIFIED, HYDROMETEOR_CLOUD, "
            "HYDROMETEOR_RAIN, HYDROMETEOR_ICE, HYDROMETEOR_SNOW, HYDROMETEOR_GRAUPEL, "
            "HYDROMETEOR_HAIL",
            "VALUE_UNKNOWN",
            {{"allowed",
              "HYDROMETEOR_UNSPECIFIED, HYDROMETEOR_CLOUD, HYDROMETEOR_RAIN, HYDROMETEOR_ICE, "
              "HYDROMETEOR_SNOW, HYDROMETEOR_GRAUPEL, HYDROMETEOR_HAIL"}}},
        DetailsCase{R"({"lights": [{}, {}, {}, {}, {}]})",
                    "scene.lights",
                    "has 5 items; it may have at most 4",
                    "TOO_MANY_ITEMS",
                    {{"maximum", "4"}, {"unit", "items"}}},
        DetailsCase{
            R"({"sun": {"clock": {"dateTime": "2013-05-20T20:00:00Z and some seconds later"}}})",
            "scene.sun.clock.date_time",
            "is 43 bytes long; it may be at most 40 bytes",
            "TEXT_TOO_LONG",
            {{"maximum", "40"}, {"unit", "bytes"}}},
        DetailsCase{R"({"sun": {"clock": {"dateTime": "noon"}}})", "scene.sun.clock.date_time",
                    "is 'noon'; it must be a date and time like 2013-05-20T20:00:00Z",
                    "DATE_TIME_MALFORMED"},
        DetailsCase{R"({"fields": [{"scale": 1}]})", "scene.fields[0].hydrometeor",
                    "is not given; it must name the field that the settings are for",
                    "FIELD_MISSING"},
        DetailsCase{R"({"fields": [{"hydrometeor": 2}, {"hydrometeor": 1}, {"hydrometeor": 2}]})",
                    "scene.fields[2].hydrometeor",
                    "is HYDROMETEOR_RAIN, as is scene.fields[0]; each hydrometeor may be "
                    "listed once",
                    "HYDROMETEOR_REPEATED"},
        DetailsCase{
            R"({"output": {"widthPx": 8192, "heightPx": 8192}})",
            "scene.output",
            "scene.output.width_px times scene.output.height_px is 8192 x 8192 = 67108864; it "
            "must be at most 33554432 pixels",
            "PICTURE_TOO_LARGE",
            {{"maximum", "33554432"}, {"unit", "pixels"}}},
        DetailsCase{R"({"timeIndex": 4})",
                    "scene.time_index",
                    "is 4; storm 'anvil' has times 0 to 3",
                    "VALUE_OUT_OF_RANGE",
                    {{"minimum", "0"}, {"maximum", "3"}}}));

TEST(ErrorDetailsTest, WhatIsNotFoundHasItsReason) {
  FakeService service;
  constexpr auto kNotFound = grpc::StatusCode::NOT_FOUND;
  v1::DescribeStormRequest describe;
  describe.set_storm_id("hurricane");
  v1::DescribeStormResponse described;
  const grpc::Status no_storm = Call(service.stub(), &Stub::DescribeStorm, describe, &described);
  ExpectRefusal(no_storm, kNotFound, "STORM_NOT_FOUND");
  EXPECT_THAT(Decode(no_storm).metadata, ElementsAre(Pair("storm_id", "hurricane")));
  v1::UpdateSceneResponse updated;
  ExpectRefusal(Call(service.stub(), &Stub::UpdateScene, v1::UpdateSceneRequest(), &updated),
                kNotFound, "SESSION_NOT_FOUND");
  v1::AcknowledgeFrameRequest acknowledge;
  acknowledge.set_session_id(service.Open(SmallScene()));
  acknowledge.set_viewer_id(7);
  v1::AcknowledgeFrameResponse acknowledged;
  const grpc::Status no_viewer =
      Call(service.stub(), &Stub::AcknowledgeFrame, acknowledge, &acknowledged);
  ExpectRefusal(no_viewer, kNotFound, "VIEWER_NOT_FOUND");
  EXPECT_THAT(Decode(no_viewer).metadata, ElementsAre(Pair("viewer_id", "7")));
}

TEST(ErrorDetailsTest, AStreamThatEndsHasItsReason) {
  FakeService service;
  const std::string closed = service.Open(SmallScene());
  Watcher watcher(service.stub(), closed);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  v1::CloseSessionRequest close;
  close.set_session_id(closed);
  v1::CloseSessionResponse response;
  ASSERT_TRUE(Call(service.stub(), &Stub::CloseSession, close, &response).ok());
  ExpectRefusal(watcher.End(), grpc::StatusCode::NOT_FOUND, "SESSION_CLOSED");
  Watcher other(service.stub(), service.Open(SmallScene()));
  ASSERT_TRUE(other.AwaitFrame(1, true));
  service.server().Shutdown();
  ExpectRefusal(other.End(), grpc::StatusCode::UNAVAILABLE, "SHUTTING_DOWN");
}

TEST(ErrorDetailsTest, WithoutRoomForASessionItSaysWhenToTryAgain) {
  service::ServerOptions options;
  options.sessions.max_sessions = 1;
  FakeService service(options);
  service.Open(SmallScene());
  v1::CreateSessionResponse response;
  const grpc::Status full =
      Call(service.stub(), &Stub::CreateSession, v1::CreateSessionRequest(), &response);
  ExpectRefusal(full, grpc::StatusCode::RESOURCE_EXHAUSTED, "TOO_MANY_SESSIONS");
  EXPECT_EQ(Decode(full).retry_s, 30.0);
  EXPECT_THAT(Decode(full).metadata, ElementsAre(Pair("maximum", "1"), Pair("unit", "sessions")));
}

TEST(ErrorDetailsTest, PicturesThatCannotBeMadeHaveTheirReason) {
  FakeService service;
  service.store->FailAt(1, absl::DataLossError("wrfout_1: QRAIN is truncated"));
  service.store->FailAt(2, absl::InvalidArgumentError("wrfout_2: dx is 0"));
  service.machine->fails_above_exposure_ev = 5.0;
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  v1::RenderImageResponse response;
  const auto render = [&](std::uint32_t time_index) {
    request.mutable_scene()->set_time_index(time_index);
    return Call(service.stub(), &Stub::RenderImage, request, &response);
  };
  const grpc::Status truncated = render(1);
  ExpectRefusal(truncated, grpc::StatusCode::DATA_LOSS, "STORM_UNREADABLE");
  EXPECT_THAT(Decode(truncated).metadata, ElementsAre(Pair("storm_id", "anvil")));
  const Decoded wrong = Decode(render(2));
  EXPECT_EQ(wrong.reason, "STORM_UNREADABLE");
  EXPECT_EQ(wrong.field, "scene.storm_id");
  EXPECT_EQ(wrong.description, "wrfout_2: dx is 0");
  request.mutable_scene()->mutable_display()->set_exposure_ev(6);
  ExpectRefusal(render(0), grpc::StatusCode::INTERNAL, "SCENE_NOT_DRAWN");
}

TEST(ErrorDetailsTest, PicturesThatMustWaitTooLongSayWhenToTryAgain) {
  service::ServerOptions options;
  options.render_loop.max_waiting_images = 0;
  FakeService service(options);
  v1::RenderImageRequest request;
  *request.mutable_scene() = SmallScene();
  v1::RenderImageResponse response;
  const grpc::Status full = Call(service.stub(), &Stub::RenderImage, request, &response);
  ExpectRefusal(full, grpc::StatusCode::RESOURCE_EXHAUSTED, "RENDER_QUEUE_FULL");
  EXPECT_EQ(Decode(full).retry_s, 5.0);
}

TEST(ErrorDetailsTest, CloudsThatAreNotMadeOrDeletedHaveTheirReason) {
  const TemporaryFolder folder;
  service::ServerOptions keeping;
  keeping.clouds_folder = folder.Path().string();
  FakeService with(keeping);
  FakeService without;
  v1::GenerateCloudRequest make;
  v1::GenerateCloudResponse made;
  ExpectRefusal(Call(without.stub(), &Stub::GenerateCloud, make, &made),
                grpc::StatusCode::FAILED_PRECONDITION, "NO_CLOUDS_FOLDER");
  v1::DeleteCloudRequest remove;
  v1::DeleteCloudResponse removed;
  remove.set_storm_id("anvil");
  ExpectRefusal(Call(with.stub(), &Stub::DeleteCloud, remove, &removed),
                grpc::StatusCode::FAILED_PRECONDITION, "STORM_NOT_DELETABLE");
  remove.set_storm_id("nimbus");
  ExpectRefusal(Call(with.stub(), &Stub::DeleteCloud, remove, &removed),
                grpc::StatusCode::NOT_FOUND, "STORM_NOT_FOUND");
  make.set_threshold(1.0F);
  const Decoded high = Decode(Call(with.stub(), &Stub::GenerateCloud, make, &made));
  EXPECT_EQ(high.reason, "VALUE_OUT_OF_RANGE");
  EXPECT_EQ(high.field, "threshold");
  EXPECT_EQ(high.description, "the threshold is 1; it must be at least 0 and below 1");
  make.set_threshold(0.99F);
  const Decoded empty = Decode(Call(with.stub(), &Stub::GenerateCloud, make, &made));
  EXPECT_EQ(empty.reason, "CLOUD_EMPTY");
  EXPECT_EQ(empty.field, "threshold");
  EXPECT_THAT(empty.description, StartsWith("no cell holds any cloud"));
  make.Clear();
  make.set_octaves(16);
  make.set_feature_size_m(10.0F);
  const Decoded fine = Decode(Call(with.stub(), &Stub::GenerateCloud, make, &made));
  EXPECT_EQ(fine.reason, "DETAIL_TOO_FINE");
  EXPECT_EQ(fine.field, "octaves");
}

TEST(ErrorDetailsTest, OneCloudIsMadeAtATime) {
  const TemporaryFolder folder;
  FakeStormStore store;
  service::CloudStore clouds(folder.Path().string(), store);
  const auto shape = clouds::PresetNamed("fair-weather-cumulus", 1);
  ASSERT_TRUE(shape.ok());
  absl::Status second;
  const auto meanwhile = [&](double) {
    std::thread([&] { second = clouds.Make(*shape, {"a", 2}, {}, {}).status(); }).join();
  };
  ASSERT_TRUE(clouds.Make(*shape, {"a", 1}, meanwhile, {}).ok());
  const grpc::Status busy = rpc_port::ToGrpcStatus(second);
  ExpectRefusal(busy, grpc::StatusCode::UNAVAILABLE, "CLOUD_BEING_MADE");
  EXPECT_EQ(Decode(busy).retry_s, 3.0);
}

// A cloud that is generated quickly.
clouds::CloudShape CoarseCloud() {
  auto shape = clouds::PresetNamed("fair-weather-cumulus", 1);
  EXPECT_TRUE(shape.ok());
  shape->grid.cells = {8, 8, 8};
  shape->grid.spacing_m *= 8.0;
  shape->noise.octaves = 1;
  return *shape;
}

TEST(ErrorDetailsTest, NobodyMakesMoreCloudsThanTheirShare) {
  const TemporaryFolder folder;
  FakeStormStore store;
  service::CloudStore clouds(folder.Path().string(), store);
  const clouds::CloudShape shape = CoarseCloud();
  std::uint64_t seed = 0;
  const auto make = [&](const std::string& owner) {
    return clouds.Make(shape, {"a", ++seed}, {}, {}, owner);
  };
  const auto first = make("anna");
  ASSERT_TRUE(first.ok()) << first.status();
  for (int i = 1; i < 32; ++i) ASSERT_TRUE(make("anna").ok());
  const grpc::Status full = rpc_port::ToGrpcStatus(make("anna").status());
  ExpectRefusal(full, grpc::StatusCode::RESOURCE_EXHAUSTED, "TOO_MANY_CLOUDS");
  EXPECT_EQ(Decode(full).metadata.at("maximum"), "32");
  EXPECT_TRUE(make("ben").ok());
  ASSERT_TRUE(clouds.Delete((*first)->id).ok());
  EXPECT_TRUE(make("anna").ok());
}

TEST(ErrorDetailsTest, NoMoreCloudsThanTheMaximum) {
  const TemporaryFolder folder;
  FakeStormStore store;
  service::CloudStore clouds(folder.Path().string(), store);
  const clouds::CloudShape shape = CoarseCloud();
  for (int i = 0; i < 64; ++i) {
    const auto made = clouds.Make(shape, {"a", static_cast<std::uint64_t>(i)}, {}, {});
    ASSERT_TRUE(made.ok()) << made.status();
  }
  const grpc::Status full = rpc_port::ToGrpcStatus(clouds.Make(shape, {"a", 64}, {}, {}).status());
  ExpectRefusal(full, grpc::StatusCode::RESOURCE_EXHAUSTED, "TOO_MANY_CLOUDS");
  EXPECT_EQ(Decode(full).metadata.at("maximum"), "64");
  EXPECT_EQ(Decode(full).retry_s, 60.0);
}

TEST(ErrorDetailsTest, ALongMessageIsCutShortInsteadOfLosingTheStatus) {
  FakeService service;
  // "ü" takes two bytes, but six bytes in grpc-message.
  std::string umlauts;
  for (int i = 0; i < 6000; ++i) umlauts += "ü";
  for (const std::string& log : {std::string(12'000, 'x'), umlauts}) {
    service.store->FailAt(1, absl::InvalidArgumentError(log));
    v1::DescribeStormRequest request;
    request.set_time_index(1);
    v1::DescribeStormResponse response;
    const grpc::Status refusal = Call(service.stub(), &Stub::DescribeStorm, request, &response);
    EXPECT_EQ(refusal.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << refusal.error_message();
    EXPECT_THAT(refusal.error_message(), StartsWith(log.substr(0, 600)));
    EXPECT_THAT(refusal.error_message(), ::testing::EndsWith("..."));
    EXPECT_EQ(Decode(refusal).reason, "STORM_UNREADABLE");
  }
}

}  // namespace
}  // namespace thunderhead::testing
