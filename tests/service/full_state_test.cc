// Tests of `thunderhead serve` whose state folder is on a disk that becomes full. The test mounts a
// small file system in its own namespace. It is skipped if the machine refuses that.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/interacting.h"
#include "tests/service/running_program.h"
#include "tests/service/served_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Stub = v1::ThunderheadService::Stub;

// More sessions than fit in the space that SQLite already has on the disk.
constexpr int kMaxSessions = 40;

constexpr char kStorm[] = THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc";

class SmallStateDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("unshare -rm true 2>/dev/null") != 0) {
      GTEST_SKIP() << "no namespaces here: unshare -rm is refused";
    }
    fs::create_directory(state_);
  }

  // Returns the path of a script that mounts a small disk as the state folder, runs `then`, and
  // starts the program with the script's arguments.
  std::string Starter(const std::string& then) const {
    const std::string starter = folder_.File("start");
    std::ofstream(starter)
        << "#!/bin/sh\nexec unshare -rm sh -c 'mount -t tmpfs -o size=8m,mode=700 none " << state_
        << " && " << then << "; exec " << PROGRAM << " \"$@\"' sh \"$@\"\n";
    fs::permissions(starter, fs::perms::owner_all);
    return starter;
  }

  const TemporaryFolder folder_;
  const std::string state_ = folder_.File("state");
};

TEST_F(SmallStateDisk, AServerThatFindsItFullAtItsStartSaysSo) {
  const std::string fill =
      absl::StrCat("dd if=/dev/zero of=", state_, "/filler bs=4096 2>/dev/null");
  const std::string err = folder_.File("err");
  RunningProgram program(Starter(fill),
                         {"serve", "--data", kStorm, "--state", state_, "--grpc", "127.0.0.1:0",
                          "--http", "127.0.0.1:0"},
                         folder_.File("out"), err);
  EXPECT_NE(program.Wait().code, 0);
  std::ifstream said(err);
  const std::string text{std::istreambuf_iterator<char>(said), {}};
  EXPECT_THAT(text, HasSubstr("its disk is full: free some space"));
  EXPECT_THAT(text, HasSubstr(state_));
}

class FullStateTest : public SmallStateDisk {
 protected:
  void SetUp() override {
    SmallStateDisk::SetUp();
    if (IsSkipped()) return;
    program_.emplace(Starter("true"), kStorm, state_,
                     std::vector<std::string>{"--max-sessions-each", "64"});
    ASSERT_NE(program_->stub(), nullptr);
  }

  // The path, seen from the program's namespace, of the file that fills the remaining space.
  std::string FillerPath() const {
    return absl::StrCat("/proc/", program_->process(), "/root", state_, "/filler");
  }

  void FillDisk() const {
    std::ofstream filler(FillerPath(), std::ios::binary);
    ASSERT_TRUE(filler.is_open());
    const std::string page(4096, '\0');
    while (filler.write(page.data(), static_cast<std::streamsize>(page.size())).flush()) continue;
  }

  v1::CreateSessionResponse Create() {
    v1::CreateSessionRequest request;
    request.mutable_scene()->mutable_output()->set_width_px(64);
    request.mutable_scene()->mutable_output()->set_height_px(36);
    v1::CreateSessionResponse created;
    const grpc::Status status = Call(*program_->stub(), &Stub::CreateSession, request, &created);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return created;
  }

  grpc::Status Close(const std::string& key) {
    v1::CloseSessionRequest request;
    request.set_session_id(key);
    v1::CloseSessionResponse response;
    return Call(*program_->stub(), &Stub::CloseSession, request, &response);
  }

  std::optional<ServedProgram> program_;
};

TEST_F(FullStateTest, SessionsThatAreNotSavedSaySoUntilThereIsRoom) {
  ASSERT_TRUE(Create().durable());
  FillDisk();
  std::vector<std::string> saved;
  v1::CreateSessionResponse last = Create();
  for (; last.durable() && saved.size() < kMaxSessions; last = Create()) {
    saved.push_back(last.session_id());
  }
  ASSERT_TRUE(last.has_durable());
  ASSERT_FALSE(last.durable()) << "the disk never was full";
  // A session that could not be saved works like any other session.
  {
    Interacting presenter(*program_->stub(), last.session_id());
    EXPECT_TRUE(presenter.AwaitFrame(last.scene_revision()));
  }
  fs::remove(FillerPath());
  EXPECT_TRUE(Create().durable());
  EXPECT_TRUE(Close(last.session_id()).ok());
}

TEST_F(FullStateTest, EndsOfSessionsThatAreNotSavedSaySo) {
  std::vector<std::string> keys;
  for (int i = 0; i < kMaxSessions; ++i) {
    const auto created = Create();
    ASSERT_TRUE(created.durable());
    keys.push_back(created.session_id());
  }
  FillDisk();
  grpc::Status closed;
  for (; closed.ok() && !keys.empty(); keys.pop_back()) closed = Close(keys.back());
  EXPECT_EQ(closed.error_code(), grpc::StatusCode::UNAVAILABLE) << "the disk never was full";
  EXPECT_THAT(closed.error_message(), HasSubstr("the session is closed, but exists again"));
  EXPECT_THAT(closed.error_message(), HasSubstr("full"));
  fs::remove(FillerPath());
  ASSERT_FALSE(keys.empty());
  EXPECT_TRUE(Close(keys.back()).ok());
}

}  // namespace
}  // namespace thunderhead::testing
