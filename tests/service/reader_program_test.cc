// Tests of `thunderhead serve` while the program that reads its storm files changes on the disk.
#include <filesystem>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/fake_service.h"
#include "tests/service/served_program.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"
#include "thunderhead/v1/thunderhead.grpc.pb.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

void WriteStorm(const std::string& path) {
  SyntheticWrf storm;
  storm.mixing_ratios["QCLOUD"] = [](const WrfCell& cell) { return cell.level < 4 ? 1e-3 : 0.0; };
  WriteWrf(storm, path);
}

class ReaderProgramTest : public ::testing::Test {
 protected:
  void SetUp() override {
    // The storms have the same time, so they form no series. The server draws the first as it
    // starts, and an idle reader may still belong to the first or the last.
    fs::create_directory(folder_.File("data"));
    for (const char* const storm : {"anvil", "tower", "wall"}) {
      WriteStorm(folder_.File(absl::StrCat("data/", storm, ".nc")));
    }
    fs::create_directory(folder_.File("bin"));
    fs::copy_file(PROGRAM, folder_.File("bin/thunderhead"));
    fs::copy_file(fs::path(PROGRAM).parent_path() / "thunderhead-reader", reader_);
    server_.emplace(folder_.File("bin/thunderhead"), folder_.File("data"), "none");
    ASSERT_NE(server_->stub(), nullptr);
  }

  // Makes the server read a time of the storm.
  grpc::Status Describe(const std::string& storm) {
    v1::DescribeStormRequest request;
    request.set_storm_id(storm);
    v1::DescribeStormResponse response;
    return Call(*server_->stub(), &Stub::DescribeStorm, request, &response);
  }

  const TemporaryFolder folder_;
  const std::string reader_ = folder_.File("bin/thunderhead-reader");
  std::optional<ServedProgram> server_;
};

// Backups and profilers create hard links to the reader program.
TEST_F(ReaderProgramTest, AnotherNameOfTheReaderChangesNothing) {
  fs::create_hard_link(reader_, folder_.File("backup"));
  const grpc::Status described = Describe("tower");
  EXPECT_TRUE(described.ok()) << described.error_message();
}

// A reader program of another version may expect other requests, so it must not be started.
TEST_F(ReaderProgramTest, AReplacedReaderIsNotStarted) {
  fs::copy_file(reader_, folder_.File("newer"));
  fs::rename(folder_.File("newer"), reader_);
  const grpc::Status refused = Describe("tower");
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_THAT(refused.error_message(), HasSubstr("was replaced; install all of Thunderhead"));
}

}  // namespace
}  // namespace thunderhead::testing
