// Tests of a state file whose surroundings others change: removed and replaced files, links, and
// folders that other users may write.
#include "store/state_file.h"

#include <grp.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "store/private_files.h"
#include "store/sqlite_job_store.h"
#include "store/sqlite_session_store.h"
#include "telemetry/metrics.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using session::SessionRecord;
using store::StateFile;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

SessionRecord MarkedSession(const std::string& id) {
  SessionRecord record;
  record.id = id;
  record.keys = {"presenter of " + id, "viewers of " + id};
  record.marks = {{7, 3, {{1.0, 2.0, 3.0}}, {}, "a secret", "20 10 1000.0 1000.0"}};
  return record;
}

jobs::JobRecord JobOfOne(char digit) {
  jobs::JobRecord job;
  job.id = std::string(jobs::kIdDigits, digit);
  job.result_key = "key of " + job.id;
  job.pictures.emplace_back().order.name = "a picture";
  return job;
}

std::string Contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

constexpr uid_t kOtherUser = 4711;

std::string MessageOf(const absl::Status& status) { return std::string(status.message()); }

class StateFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(state_);
    fs::permissions(state_, fs::perms::owner_all);
  }

  void Open() {
    const auto file = StateFile::Open(path_);
    ASSERT_TRUE(file.ok()) << file.status();
    sessions_ = *store::SqliteSessionStore::In(*file);
    jobs_ = *store::SqliteJobStore::In(*file);
  }

  // Ends the stores, and expects that the next run finds these numbers of sessions and jobs.
  void ExpectKept(std::size_t sessions, std::size_t jobs) {
    sessions_.reset();
    jobs_.reset();
    ASSERT_NO_FATAL_FAILURE(Open());
    EXPECT_THAT(*sessions_->Load(), SizeIs(sessions));
    EXPECT_THAT(*jobs_->Load(), SizeIs(jobs));
  }

  const TemporaryFolder folder_;
  const std::string state_ = folder_.File("state");
  const std::string path_ = state_ + "/sessions.db";
  std::unique_ptr<store::SqliteSessionStore> sessions_;
  std::unique_ptr<store::SqliteJobStore> jobs_;
};

TEST_F(StateFileTest, ARemovedFileIsWrittenAnew) {
  Open();
  ASSERT_TRUE(sessions_->Save({MarkedSession("a")}).ok());
  ASSERT_TRUE(jobs_->Add(JobOfOne('a')).ok());
  fs::remove(path_);
  EXPECT_TRUE(sessions_->Save({MarkedSession("b")}).ok());
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms(0600));
  EXPECT_TRUE(jobs_->Add(JobOfOne('b')).ok());
  fs::remove(path_);
  EXPECT_TRUE(jobs_->Add(JobOfOne('c')).ok());
  EXPECT_TRUE(sessions_->Save({MarkedSession("c")}).ok());
  ExpectKept(3, 3);
}

TEST_F(StateFileTest, ARemovedFileIsWrittenAnewAlthoughNothingHasChanged) {
  Open();
  ASSERT_TRUE(sessions_->Save({MarkedSession("a")}).ok());
  fs::remove(path_);
  EXPECT_TRUE(sessions_->Check().ok());
  ExpectKept(1, 0);
}

TEST_F(StateFileTest, AReplacedFileIsReportedAndNotChanged) {
  Open();
  ASSERT_TRUE(sessions_->Save({MarkedSession("a")}).ok());
  fs::rename(path_, state_ + "/aside");
  std::ofstream(path_) << "another file";
  for (int i = 0; i < 2; ++i) {
    const absl::Status saved = sessions_->Save({MarkedSession("b")});
    EXPECT_EQ(saved.code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(MessageOf(saved), AllOf(HasSubstr(path_ + " was replaced by another file"),
                                        HasSubstr("restart the server")));
  }
  EXPECT_FALSE(sessions_->Check().ok());
  EXPECT_FALSE(jobs_->Add(JobOfOne('a')).ok());
  EXPECT_EQ(Contents(path_), "another file");
  fs::remove(path_);
  EXPECT_TRUE(sessions_->Save({MarkedSession("b")}).ok());
  ExpectKept(2, 0);
}

TEST_F(StateFileTest, ARemovedFolderIsReportedUntilItIsThereAgain) {
  Open();
  ASSERT_TRUE(sessions_->Save({MarkedSession("a")}).ok());
  fs::remove_all(state_);
  EXPECT_THAT(MessageOf(sessions_->Save({MarkedSession("b")})), HasSubstr(state_));
  fs::create_directory(state_);
  fs::permissions(state_, fs::perms::all);
  EXPECT_THAT(MessageOf(sessions_->Save({MarkedSession("b")})), HasSubstr("chmod go-w"));
  EXPECT_TRUE(fs::is_empty(state_));
  fs::permissions(state_, fs::perms::owner_all);
  EXPECT_TRUE(sessions_->Save({MarkedSession("b")}).ok());
  ExpectKept(2, 0);
}

TEST_F(StateFileTest, ARemovedLockIsTakenAgain) {
  Open();
  fs::remove(path_ + ".lock");
  EXPECT_TRUE(sessions_->Check().ok());
  EXPECT_THAT(MessageOf(StateFile::Open(path_).status()), HasSubstr("held by another process"));
}

TEST_F(StateFileTest, NothingIsSavedWhereAnotherServerHasTakenTheLock) {
  Open();
  fs::remove(path_ + ".lock");
  const auto other = StateFile::Open(path_);
  ASSERT_TRUE(other.ok()) << other.status();
  const absl::Status saved = sessions_->Save({MarkedSession("a")});
  EXPECT_THAT(MessageOf(saved),
              AllOf(HasSubstr("cannot be taken again"), HasSubstr("held by another process")));
}

TEST_F(StateFileTest, TheLogOfAnEarlierVersionIsReadWithoutItsIndex) {
  Open();
  ASSERT_TRUE(sessions_->Save({MarkedSession("a")}).ok());
  sessions_.reset();
  jobs_.reset();
  const pid_t child = fork();
  if (child == 0) {
    // The process ends without closing the file, so its log stays.
    sqlite3* database = nullptr;
    const bool done =
        sqlite3_open(path_.c_str(), &database) == SQLITE_OK &&
        sqlite3_exec(database, "PRAGMA journal_mode = WAL; UPDATE sessions SET owner = 'late'",
                     nullptr, nullptr, nullptr) == SQLITE_OK;
    _exit(done ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  ASSERT_TRUE(fs::exists(path_ + "-wal"));
  // Mapping this index would fail.
  fs::remove(path_ + "-shm");
  ASSERT_EQ(mkfifo((path_ + "-shm").c_str(), 0600), 0);
  ASSERT_NO_FATAL_FAILURE(Open());
  const auto loaded = sessions_->Load();
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  ASSERT_THAT(*loaded, SizeIs(1));
  EXPECT_EQ(loaded->front().owner, "late");
  EXPECT_FALSE(fs::exists(path_ + "-wal"));
  EXPECT_FALSE(fs::exists(path_ + "-shm"));
}

class LinkedFilesTest : public StateFileTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(LinkedFilesTest, AreRefused) {
  const std::string file = path_ + GetParam();
  const std::string target = folder_.File("target");
  std::ofstream(target) << "precious";
  fs::create_symlink(target, file);
  EXPECT_THAT(MessageOf(StateFile::Open(path_).status()),
              AllOf(HasSubstr(file), HasSubstr("is a link")));
  EXPECT_EQ(Contents(target), "precious");
  fs::remove(target);
  EXPECT_FALSE(StateFile::Open(path_).ok());
  EXPECT_FALSE(fs::exists(target)) << "a file was created through the link";
  fs::remove(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  const absl::Status refusal = StateFile::Open(path_).status();
  EXPECT_EQ(refusal.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(MessageOf(refusal), AllOf(HasSubstr(file), HasSubstr("not a regular file")));
  fs::remove(file);
  EXPECT_TRUE(StateFile::Open(path_).ok());
}

INSTANTIATE_TEST_SUITE_P(EachFile, LinkedFilesTest,
                         ::testing::Values("", ".lock", "-journal", "-wal"));

TEST_F(StateFileTest, ALinkToTheFolderIsFollowed) {
  const std::string link = folder_.File("link");
  fs::create_directory_symlink(state_, link);
  EXPECT_TRUE(StateFile::Open(link + "/sessions.db").ok());
  EXPECT_TRUE(fs::exists(path_));
}

TEST_F(StateFileTest, ALinkThatIsPutInPlaceOfTheFileIsNotFollowed) {
  Open();
  const std::string target = folder_.File("target");
  fs::remove(path_);
  fs::create_symlink(target, path_);
  EXPECT_THAT(MessageOf(sessions_->Save({MarkedSession("a")})), HasSubstr("was replaced"));
  EXPECT_FALSE(fs::exists(target));
  std::ofstream(target).flush();
  EXPECT_FALSE(store::Database::Open(path_).ok());
}

// SQLite would open them. Opening such a FIFO waits for another process, forever.
TEST_F(StateFileTest, WhatIsPutInPlaceOfSqlitesFilesIsReportedAndNotOpened) {
  Open();
  for (const std::string& file : {path_ + "-journal", path_ + "-wal"}) {
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
    const absl::Status saved = sessions_->Save({MarkedSession("a")});
    EXPECT_EQ(saved.code(), absl::StatusCode::kUnavailable) << saved;
    EXPECT_THAT(MessageOf(saved), AllOf(HasSubstr(file), HasSubstr("not a regular file")));
    EXPECT_FALSE(jobs_->Add(JobOfOne('a')).ok());
    fs::remove(file);
    fs::create_symlink(folder_.File("target"), file);
    EXPECT_THAT(MessageOf(sessions_->Save({MarkedSession("a")})),
                AllOf(HasSubstr(file), HasSubstr("is a link")));
    fs::remove(file);
    EXPECT_TRUE(sessions_->Save({MarkedSession("a")}).ok());
  }
  ExpectKept(1, 0);
}

TEST_F(StateFileTest, ADamagedFileThatIsRemovedNeedsARestart) {
  Open();
  ASSERT_TRUE(sessions_->Save({MarkedSession("a")}).ok());
  std::fstream(path_, std::ios::in | std::ios::out | std::ios::binary) << std::string(100, '\0');
  EXPECT_TRUE(absl::IsDataLoss(sessions_->Save({MarkedSession("b")})));
  fs::remove(path_);
  for (int i = 0; i < 2; ++i) {
    const absl::Status saved = sessions_->Save({MarkedSession("b")});
    EXPECT_TRUE(absl::IsDataLoss(saved)) << saved;
    EXPECT_THAT(MessageOf(saved), AllOf(HasSubstr("was removed"), HasSubstr("restart the server")));
  }
  sessions_.reset();
  jobs_.reset();
  ExpectKept(0, 0);
}

TEST_F(StateFileTest, AFolderThatOthersMayWriteIsRefused) {
  EXPECT_TRUE(store::CheckFolder(state_).ok());
  for (const auto more : {fs::perms::group_write, fs::perms::others_write}) {
    fs::permissions(state_, fs::perms::owner_all | more);
    const absl::Status refusal = store::CheckFolder(state_);
    EXPECT_EQ(refusal.code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(MessageOf(refusal), HasSubstr("chmod go-w " + state_));
  }
  fs::permissions(state_, fs::perms(0755));
  EXPECT_TRUE(store::CheckFolder(state_).ok());
}

TEST_F(StateFileTest, AFolderOfAnotherUserIsRefused) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a folder to another user";
  ASSERT_EQ(chown(state_.c_str(), kOtherUser, 0), 0);
  EXPECT_THAT(MessageOf(store::CheckFolder(state_)),
              AllOf(HasSubstr("belongs to user 4711"), HasSubstr("chown 0 " + state_)));
}

// Kubernetes gives the folder of a volume to the group fsGroup in this way.
TEST_F(StateFileTest, RootMayLetTheServersGroupWriteTheFolder) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  fs::permissions(folder_.Path(), fs::perms(0755));
  ASSERT_EQ(chown(state_.c_str(), 0, kOtherUser), 0);
  const auto is_accepted = [&](mode_t mode, gid_t group) {
    EXPECT_EQ(chmod(state_.c_str(), mode), 0);
    const pid_t child = fork();
    if (child == 0) {
      const bool ready = setgroups(1, &group) == 0 && setuid(kOtherUser) == 0;
      _exit(!ready ? 2 : store::CheckFolder(state_).ok() ? 1 : 0);
    }
    int status = -1;
    waitpid(child, &status, 0);
    return WEXITSTATUS(status);
  };
  EXPECT_EQ(is_accepted(02775, kOtherUser), 1);
  EXPECT_EQ(is_accepted(02775, kOtherUser + 1), 0);
  EXPECT_EQ(is_accepted(02777, kOtherUser), 0);
}

TEST_F(StateFileTest, ASessionWithoutItsMarksIsRestoredAndCounted) {
  Open();
  ASSERT_TRUE(sessions_->Save({MarkedSession("a"), MarkedSession("b")}).ok());
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(
      sqlite3_exec(database, "DELETE FROM marks WHERE session_id = 'a'", nullptr, nullptr, nullptr),
      SQLITE_OK);
  sqlite3_close(database);
  const std::uint64_t before = telemetry::Counted().session_damages.Value();
  ::testing::internal::CaptureStdout();
  const auto loaded = sessions_->Load();
  EXPECT_THAT(::testing::internal::GetCapturedStdout(),
              HasSubstr("session a is restored without its marks: its marks are missing"));
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  SessionRecord without_marks = MarkedSession("a");
  without_marks.marks.clear();
  EXPECT_THAT(*loaded, ::testing::ElementsAre(without_marks, MarkedSession("b")));
  EXPECT_EQ(telemetry::Counted().session_damages.Value(), before + 1);
}

}  // namespace
}  // namespace thunderhead::testing
