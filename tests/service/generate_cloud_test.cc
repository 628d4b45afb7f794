// Clouds made on request: files in the server's folder, and storms like any other.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "clouds/presets.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "service/cloud_folder.h"
#include "tests/service/fake_service.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;
using Request = v1::GenerateCloudRequest;

class GenerateCloudTest : public ::testing::Test {
 protected:
  grpc::Status Make(const Request& request) {
    return Call(service_.stub(), &Stub::GenerateCloud, request, &response_);
  }

  grpc::Status Delete(const std::string& storm_id) {
    v1::DeleteCloudRequest request;
    request.set_storm_id(storm_id);
    v1::DeleteCloudResponse deleted;
    return Call(service_.stub(), &Stub::DeleteCloud, request, &deleted);
  }

  v1::ListStormsResponse List() {
    v1::ListStormsResponse list;
    EXPECT_TRUE(Call(service_.stub(), &Stub::ListStorms, v1::ListStormsRequest(), &list).ok());
    return list;
  }

  std::size_t Files() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.Path())) {
      ++count;
    }
    return count;
  }

  TemporaryFolder folder_;
  FakeService service_{{.clouds_folder = folder_.Path().string()}};
  v1::GenerateCloudResponse response_;
};

TEST_F(GenerateCloudTest, TheCloudIsAStormFromThenOn) {
  Request request;
  request.set_seed(7);
  ASSERT_TRUE(Make(request).ok());
  EXPECT_EQ(response_.storm().id(), "fair-weather-cumulus-7");
  EXPECT_EQ(response_.storm().time_count(), 1U);
  EXPECT_TRUE(std::filesystem::exists(folder_.Path() / "fair-weather-cumulus-7.nc"));
  v1::ListStormsResponse list;
  ASSERT_TRUE(Call(service_.stub(), &Stub::ListStorms, v1::ListStormsRequest(), &list).ok());
  ASSERT_EQ(list.storms_size(), 3);
  EXPECT_EQ(list.storms(0).id(), "anvil") << "the first storm stays the first";
  EXPECT_EQ(list.storms(2).id(), "fair-weather-cumulus-7");
}

TEST_F(GenerateCloudTest, ACloudThatWasMadeCanBeDeleted) {
  ASSERT_TRUE(Make(Request()).ok());
  const std::string id = response_.storm().id();
  EXPECT_TRUE(response_.storm().deletable());
  EXPECT_FALSE(List().storms(0).deletable());
  EXPECT_TRUE(List().storms(2).deletable());
  v1::Scene scene = SmallScene();
  scene.set_storm_id(id);
  const std::string session = service_.Open(scene);
  Watcher watcher(service_.stub(), session);
  ASSERT_TRUE(watcher.AwaitFrame(1, true));

  ASSERT_TRUE(Delete(id).ok());
  EXPECT_EQ(List().storms_size(), 2);
  EXPECT_EQ(Files(), 0U);
  const std::string told = "the cloud '" + id + "' was deleted; choose another storm";
  EXPECT_TRUE(watcher.Await([&](const std::vector<v1::WatchFramesResponse>& messages) {
    return std::any_of(messages.begin(), messages.end(), [&](const auto& message) {
      return message.has_problem() && message.problem().message() == told;
    });
  }));
  v1::UpdateSceneRequest update;
  update.set_session_id(session);
  *update.mutable_scene() = scene;
  v1::UpdateSceneResponse updated;
  const grpc::Status refused = Call(service_.stub(), &Stub::UpdateScene, update, &updated);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(refused.error_message(), HasSubstr(id));
  EXPECT_EQ(Delete(id).error_code(), grpc::StatusCode::NOT_FOUND);
  // Who still shows the old one must not get another under its name.
  ASSERT_TRUE(Make(Request()).ok());
  EXPECT_NE(response_.storm().id(), id);
}

TEST_F(GenerateCloudTest, AStormThatWasNotMadeHereIsNotDeleted) {
  const grpc::Status status = Delete("anvil");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("was not made by this server"));
  EXPECT_EQ(Delete("").error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Delete("../anvil").error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Delete(std::string(257, 'a')).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(List().storms_size(), 2);
}

TEST(CloudFolder, KnowsTheCloudsOfAnEarlierServerFromOtherFiles) {
  const TemporaryFolder folder;
  const std::string path = folder.Path().string();
  WriteCf(ExtinctionFile(4, 4, 4, 100.0, 100.0, 100.0, [](auto, auto, auto) { return 1e-3; }),
          path + "/other.nc");
  auto shape = clouds::PresetNamed("fair-weather-cumulus", 1);
  ASSERT_TRUE(shape.ok()) << shape.status();
  ASSERT_TRUE(
      clouds::WriteGenerated(*shape, {"fair-weather-cumulus", 1}, path + "/kept.nc", {}, {}).ok());
  auto store = volume::StormStore::Open({path + "/other.nc", path + "/kept.nc"}, {});
  ASSERT_TRUE(store.ok()) << store.status();
  service::CloudFolder clouds(path, **store);
  EXPECT_TRUE(clouds.Holds("kept"));
  EXPECT_FALSE(clouds.Holds("other"));
  EXPECT_EQ(clouds.Delete("other").code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(clouds.Delete("kept").ok());
  EXPECT_FALSE(std::filesystem::exists(path + "/kept.nc"));
  EXPECT_TRUE(std::filesystem::exists(path + "/other.nc"));
  EXPECT_EQ((*store)->Find("kept"), nullptr);
  // The same file outside the folder is nobody's to delete.
  const TemporaryFolder elsewhere;
  EXPECT_FALSE(service::CloudFolder(elsewhere.Path().string(), **store).Holds("other"));
}

TEST_F(GenerateCloudTest, TheSameAgainIsAnotherStorm) {
  ASSERT_TRUE(Make(Request()).ok());
  ASSERT_TRUE(Make(Request()).ok());
  EXPECT_EQ(response_.storm().id(), "fair-weather-cumulus-1-2");
  EXPECT_EQ(Files(), 2U);
}

TEST_F(GenerateCloudTest, BadParametersAreNamedAndLeaveNothing) {
  Request request;
  request.set_octaves(0);
  grpc::Status status = Make(request);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("octaves"));
  request.set_octaves(16);
  request.set_feature_size_m(10.0F);
  status = Make(request);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("too fine for cells"));
  request.Clear();
  request.add_ellipsoids()->set_radius_x_m(-5.0F);
  status = Make(request);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("ellipsoids[0].radius_x_m"));
  for (const float wrong : {std::nanf(""), -1.0F, 1e30F}) {
    request.Clear();
    request.set_persistence(wrong);
    EXPECT_THAT(Make(request).error_message(), HasSubstr("persistence"));
    request.Clear();
    request.set_base_m(wrong);
    EXPECT_THAT(Make(request).error_message(), HasSubstr("base_m"));
    request.Clear();
    request.set_water_kg_per_m3(wrong);
    EXPECT_THAT(Make(request).error_message(), HasSubstr("water_kg_per_m3"));
  }
  request.Clear();
  for (int i = 0; i < 65; ++i) request.add_ellipsoids();
  EXPECT_THAT(Make(request).error_message(), HasSubstr("ellipsoids has 65 items"));
  request.Clear();
  request.set_preset(static_cast<v1::GenerateCloudRequest::Preset>(9));
  EXPECT_THAT(Make(request).error_message(), HasSubstr("preset is 9"));
  request.Clear();
  request.set_threshold(1.0F);
  EXPECT_FALSE(Make(request).ok()) << "no cell holds any cloud";
  EXPECT_EQ(Files(), 0U);
}

TEST(GenerateCloud, AServerWithoutAFolderSaysSo) {
  FakeService service;
  v1::GenerateCloudResponse response;
  const grpc::Status status = Call(service.stub(), &Stub::GenerateCloud, Request(), &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("--clouds"));
}

}  // namespace
}  // namespace thunderhead::testing
