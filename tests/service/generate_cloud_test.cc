// Clouds made on request: files in the server's folder, and storms like any other.
#include <filesystem>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
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
