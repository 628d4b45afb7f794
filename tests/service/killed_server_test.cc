// Tests of the program itself, killed and restarted: all viewers who come back find the same
// session.
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "store/sqlite.h"
#include "tests/service/interacting.h"
#include "tests/service/served_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using Response = v1::InteractResponse;
using Stub = v1::ThunderheadService::Stub;

const std::string kServedSample = std::string(THUNDERHEAD_SOURCE_DIR) + "/samples/supercell.nc";
constexpr int kViewers = 200;

v1::Scene SmallSceneWithSun(float azimuth_deg) {
  v1::Scene scene;
  scene.mutable_output()->set_width_px(64);
  scene.mutable_output()->set_height_px(36);
  scene.mutable_sun()->set_azimuth_deg(azimuth_deg);
  return scene;
}

v1::InteractRequest DrawsDownwards() {
  v1::InteractRequest request;
  v1::Ray& ray = *request.mutable_add_mark()->add_rays();
  ray.mutable_origin()->set_z_m(30000.0F);
  ray.mutable_direction()->set_z(-1.0F);
  return request;
}

class KilledServerTest : public ::testing::Test {
 protected:
  std::unique_ptr<ServedProgram> Start() const {
    return std::make_unique<ServedProgram>(PROGRAM, kServedSample, state_);
  }

  // Returns whether the state folder has the session's marks and its scene of at least that
  // revision.
  bool HasSavedMarks(std::uint64_t revision) const {
    absl::StatusOr<store::Database> database = store::Database::Open(state_ + "/sessions.db");
    if (!database.ok()) return false;
    const absl::StatusOr<std::int64_t> sessions = database->Number(
        absl::StrCat("SELECT count(*) FROM sessions JOIN marks ON session_id = id WHERE "
                     "scene_revision >= ",
                     revision, " AND owner_keys <> ''"));
    return sessions.ok() && *sessions == 1;
  }

  const TemporaryFolder folder_;
  const std::string state_ = folder_.File("new/state");
};

TEST_F(KilledServerTest, EverybodyFindsTheSameSessionAgain) {
  auto program = Start();
  ASSERT_NE(program->stub(), nullptr);
  EXPECT_EQ(std::filesystem::status(state_).permissions(), std::filesystem::perms(0700));
  v1::CreateSessionRequest request;
  *request.mutable_scene() = SmallSceneWithSun(10.0F);
  v1::CreateSessionResponse created;
  ASSERT_TRUE(Call(*program->stub(), &Stub::CreateSession, request, &created).ok());
  // A session is stored before its client learns of it.
  program->End(SIGKILL);
  program = Start();
  ASSERT_NE(program->stub(), nullptr);

  std::uint64_t revision = 0;
  std::string marks;
  {
    Interacting presenter(*program->stub(), created.session_id());
    std::vector<std::unique_ptr<Interacting>> viewers;
    for (int i = 0; i < kViewers; ++i) {
      viewers.push_back(std::make_unique<Interacting>(*program->stub(), created.viewer_key()));
    }
    ASSERT_EQ(presenter.AwaitNewest(Response::kJoined).joined().role(), v1::ROLE_PRESENTER);
    v1::InteractRequest turns;
    *turns.mutable_update_scene()->mutable_scene() = SmallSceneWithSun(222.0F);
    const Response taken = presenter.Answer(presenter.Send(turns));
    ASSERT_TRUE(taken.has_scene_taken()) << taken.ShortDebugString();
    revision = taken.scene_taken().scene_revision();
    presenter.Send(DrawsDownwards());
    for (const auto& viewer : viewers) {
      ASSERT_TRUE(viewer->AwaitFrame(revision));
      marks = viewer->AwaitNewest(Response::kMarks).marks().SerializeAsString();
    }
    ASSERT_FALSE(marks.empty());
    ASSERT_TRUE(WaitFor([&] { return HasSavedMarks(revision); }));
    program->End(SIGKILL);
    EXPECT_EQ(presenter.End().error_code(), grpc::StatusCode::UNAVAILABLE);
  }

  program = Start();
  ASSERT_NE(program->stub(), nullptr);
  std::vector<std::unique_ptr<Interacting>> everybody;
  for (int i = 0; i < kViewers; ++i) {
    everybody.push_back(std::make_unique<Interacting>(*program->stub(), created.viewer_key()));
  }
  everybody.push_back(std::make_unique<Interacting>(*program->stub(), created.session_id()));
  for (const auto& person : everybody) {
    const v1::SceneState scene = person->AwaitNewest(Response::kScene).scene();
    EXPECT_EQ(scene.scene().sun().azimuth_deg(), 222.0F);
    EXPECT_GT(scene.scene_revision(), revision);
    EXPECT_EQ(person->AwaitNewest(Response::kMarks).marks().SerializeAsString(), marks);
    EXPECT_TRUE(person->AwaitFrame(scene.scene_revision()));
    // All viewers are in one session instead of one session each.
    EXPECT_TRUE(person->AwaitPresence([&](const v1::Presence& presence) {
      return presence.people_size() == kViewers + 1 &&
             presence.steering_viewer_id() == everybody.back()->viewer_id();
    }));
  }
}

TEST_F(KilledServerTest, AStoppedServerKeepsWhatHappenedLast) {
  auto program = Start();
  ASSERT_NE(program->stub(), nullptr);
  v1::CreateSessionResponse created;
  ASSERT_TRUE(
      Call(*program->stub(), &Stub::CreateSession, v1::CreateSessionRequest(), &created).ok());
  v1::UpdateSceneRequest update;
  update.set_session_id(created.session_id());
  *update.mutable_scene() = SmallSceneWithSun(99.0F);
  v1::UpdateSceneResponse updated;
  ASSERT_TRUE(Call(*program->stub(), &Stub::UpdateScene, update, &updated).ok());
  program->End(SIGTERM);
  program = Start();
  ASSERT_NE(program->stub(), nullptr);
  Interacting viewer(*program->stub(), created.viewer_key());
  EXPECT_EQ(viewer.AwaitNewest(Response::kScene).scene().scene().sun().azimuth_deg(), 99.0F);
}

TEST_F(KilledServerTest, EachServerNeedsAStateFolderOfItsOwn) {
  const auto program = Start();
  ASSERT_NE(program->stub(), nullptr);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(Start()->stub(), nullptr);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              ::testing::AllOf(::testing::HasSubstr(state_), ::testing::HasSubstr("--state")));
}

TEST_F(KilledServerTest, AStateFileThatIsRemovedIsWrittenAnew) {
  auto program = Start();
  ASSERT_NE(program->stub(), nullptr);
  const v1::CreateSessionRequest request;
  v1::CreateSessionResponse before;
  ASSERT_TRUE(Call(*program->stub(), &Stub::CreateSession, request, &before).ok());
  std::filesystem::remove(state_ + "/sessions.db");
  v1::CreateSessionResponse after;
  ASSERT_TRUE(Call(*program->stub(), &Stub::CreateSession, request, &after).ok());
  EXPECT_TRUE(after.durable());
  // The server writes the file again even if no session changes.
  std::filesystem::remove(state_ + "/sessions.db");
  EXPECT_TRUE(WaitFor([&] { return std::filesystem::exists(state_ + "/sessions.db"); }));
  program->End(SIGKILL);
  program = Start();
  ASSERT_NE(program->stub(), nullptr);
  for (const auto& session : {before, after}) {
    Interacting viewer(*program->stub(), session.viewer_key());
    EXPECT_TRUE(viewer.AwaitNewest(Response::kScene).has_scene());
  }
}

TEST_F(KilledServerTest, SessionsAreNotDurableWhileTheirFileIsReplaced) {
  ::testing::internal::CaptureStderr();
  const auto program = Start();
  ASSERT_NE(program->stub(), nullptr);
  const v1::CreateSessionRequest request;
  v1::CreateSessionResponse created;
  ASSERT_TRUE(Call(*program->stub(), &Stub::CreateSession, request, &created).ok());
  EXPECT_TRUE(created.durable());
  std::filesystem::copy(state_ + "/sessions.db", state_ + "/copy");
  std::filesystem::rename(state_ + "/copy", state_ + "/sessions.db");
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(Call(*program->stub(), &Stub::CreateSession, request, &created).ok());
    EXPECT_FALSE(created.durable());
  }
  std::filesystem::remove(state_ + "/sessions.db");
  ASSERT_TRUE(Call(*program->stub(), &Stub::CreateSession, request, &created).ok());
  EXPECT_TRUE(created.durable());
  const std::string log = ::testing::internal::GetCapturedStderr();
  const std::string line = "sessions.db was replaced by another file";
  const std::size_t first = log.find(line);
  EXPECT_NE(first, std::string::npos) << log;
  EXPECT_EQ(log.find(line, first + 1), std::string::npos) << log;
}

// While the object lives, programs that are started put their temporary files in a folder.
class TemporaryFiles {
 public:
  explicit TemporaryFiles(const std::string& folder) {
    const char* const before = getenv("TMPDIR");
    if (before != nullptr) before_ = before;
    setenv("TMPDIR", folder.c_str(), 1);
  }
  ~TemporaryFiles() {
    before_.has_value() ? setenv("TMPDIR", before_->c_str(), 1) : unsetenv("TMPDIR");
  }
  TemporaryFiles(const TemporaryFiles&) = delete;
  TemporaryFiles& operator=(const TemporaryFiles&) = delete;

 private:
  std::optional<std::string> before_;
};

// Returns the cloud folders within a temporary folder.
std::vector<std::string> CloudFolders(const std::string& parent) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(parent)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("thunderhead-clouds-")) names.push_back(name);
  }
  return names;
}

TEST_F(KilledServerTest, TheNextDeletesItsTemporaryClouds) {
  const std::string parent = folder_.File("tmp");
  std::filesystem::create_directory(parent);
  const TemporaryFiles temporary(parent);
  const auto start = [&](const std::string& state) {
    return std::make_unique<ServedProgram>(PROGRAM, kServedSample, folder_.File(state));
  };
  const auto make_old = [&](const std::string& name) {
    const std::filesystem::path path = std::filesystem::path(parent) / name;
    std::filesystem::last_write_time(
        path, std::filesystem::file_time_type::clock::now() - std::chrono::minutes(5));
  };
  const auto alive = start("one");
  ASSERT_NE(alive->stub(), nullptr);
  const std::vector<std::string> of_alive = CloudFolders(parent);
  ASSERT_EQ(of_alive.size(), 1U);
  auto killed = start("two");
  ASSERT_NE(killed->stub(), nullptr);
  ASSERT_EQ(CloudFolders(parent).size(), 2U);
  killed->End(SIGKILL);
  for (const std::string& name : CloudFolders(parent)) make_old(name);
  std::filesystem::create_directory(parent + "/thunderhead-clouds-starts");

  killed = start("three");
  ASSERT_NE(killed->stub(), nullptr);
  // There are three: the folder of the running server, the folder of the third server, and the new
  // folder without a lock.
  EXPECT_EQ(CloudFolders(parent).size(), 3U);
  EXPECT_THAT(CloudFolders(parent), ::testing::Contains(of_alive.front()));
  killed->End(SIGTERM);
  EXPECT_THAT(CloudFolders(parent),
              ::testing::UnorderedElementsAre(of_alive.front(), "thunderhead-clouds-starts"));
}

}  // namespace
}  // namespace thunderhead::testing
