// Tests of the store's file: what is restored, who may read it, and which files are refused with
// which messages.
#include "store/sqlite_session_store.h"

#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "store/mark_bytes.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

using session::SessionRecord;
using store::SqliteSessionStore;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

SessionRecord SessionRecordOf(const std::string& id) {
  SessionRecord record;
  record.id = id;
  record.keys = {"presenter of " + id, "viewers of " + id};
  record.owner = "anna";
  record.rules = {.viewers_may_steer = false,
                  .control_locked = true,
                  .following_locked = false,
                  .viewers_may_mark = true,
                  .free_when_away = true};
  record.control = {.viewer_key = "another secret", .viewer_name = "Ana", .viewer_id = 11};
  record.scene = std::string("a\0scene\xff", 8);
  record.scene_revision = 1ULL << 40;
  record.marks = {
      {7, 3, {{1.5, -2e6, 0.1}, {4.0, 5.0, 6.0}}, {0.25F, 0.5F, 1.0F}, "", "20 10 1000.0 1000.0"},
      {9, 4, {}, {}, "a secret"}};
  record.last_used =
      std::chrono::system_clock::time_point(std::chrono::milliseconds(1'700'000'000'123));
  return record;
}

// Runs SQL on the file without the store's knowledge.
void Execute(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

int Rows(const std::string& path, const std::string& table) {
  int rows = -1;
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  sqlite3_exec(
      database, ("SELECT count(*) FROM " + table).c_str(),
      [](void* count, int, char** values, char**) {
        *static_cast<int*>(count) = std::stoi(values[0]);
        return 0;
      },
      &rows, nullptr);
  sqlite3_close(database);
  return rows;
}

class SqliteSessionStoreTest : public ::testing::Test {
 protected:
  std::unique_ptr<SqliteSessionStore> Open() const {
    auto store = SqliteSessionStore::Open(path_);
    EXPECT_TRUE(store.ok()) << store.status();
    return store.ok() ? *std::move(store) : nullptr;
  }

  absl::Status Refusal() const {
    const absl::Status status = SqliteSessionStore::Open(path_).status();
    EXPECT_THAT(std::string(status.message()), HasSubstr(path_));
    return status;
  }

  // Returns the records that a later run finds.
  std::vector<SessionRecord> Loaded() const {
    const auto records = Open()->Load();
    EXPECT_TRUE(records.ok()) << records.status();
    return records.ok() ? *records : std::vector<SessionRecord>();
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("sessions.db");
};

TEST_F(SqliteSessionStoreTest, EveryFieldComesBack) {
  ASSERT_TRUE(Open()->Save({SessionRecordOf("b"), SessionRecordOf("a")}).ok());
  EXPECT_THAT(Loaded(), ElementsAre(SessionRecordOf("a"), SessionRecordOf("b")));
}

TEST_F(SqliteSessionStoreTest, TheNewestIsKeptAndTheRemovedIsGone) {
  SessionRecord changed = SessionRecordOf("a");
  changed.scene = "another";
  changed.scene_revision = 3;
  changed.rules = {};
  changed.control = {.is_free = true};
  changed.marks.erase(changed.marks.begin());
  changed.last_used += std::chrono::hours(1);
  SessionRecord moved = SessionRecordOf("c");
  moved.scene = "another view of the same marks";
  {
    const auto store = Open();
    ASSERT_TRUE(
        store->Save({SessionRecordOf("a"), SessionRecordOf("b"), SessionRecordOf("c")}).ok());
    ASSERT_TRUE(store->Save({changed, moved}).ok());
    ASSERT_TRUE(store->Remove({"b", "unknown"}).ok());
  }
  EXPECT_THAT(Loaded(), ElementsAre(changed, moved));
  EXPECT_EQ(Rows(path_, "sessions"), 2);
  EXPECT_EQ(Rows(path_, "marks"), 2);
}

TEST_F(SqliteSessionStoreTest, MarksOfAFileWithoutOwnersComeBackWithoutThem) {
  ASSERT_TRUE(Open()->Save({SessionRecordOf("a")}).ok());
  Execute(path_,
          "ALTER TABLE sessions DROP COLUMN steering_key; "
          "ALTER TABLE sessions DROP COLUMN steering_name; "
          "ALTER TABLE sessions DROP COLUMN steering_id; "
          "ALTER TABLE sessions DROP COLUMN control_is_free; "
          "ALTER TABLE sessions DROP COLUMN owner; ALTER TABLE marks DROP COLUMN owner_keys; "
          "ALTER TABLE marks DROP COLUMN domains; "
          "PRAGMA user_version = 2");
  SessionRecord without_owners = SessionRecordOf("a");
  without_owners.owner.clear();
  without_owners.control = {};
  for (session::Mark& mark : without_owners.marks) {
    mark.owner_key.clear();
    mark.domain.clear();
  }
  EXPECT_THAT(Loaded(), ElementsAre(without_owners));
  // The owners are written although the marks are the same.
  ASSERT_TRUE(Open()->Save({SessionRecordOf("a")}).ok());
  EXPECT_THAT(Loaded(), ElementsAre(SessionRecordOf("a")));
}

TEST_F(SqliteSessionStoreTest, AllRecordsAreSavedOrNone) {
  SessionRecord same_key = SessionRecordOf("b");
  same_key.keys = SessionRecordOf("a").keys;
  const auto store = Open();
  EXPECT_FALSE(store->Save({SessionRecordOf("a"), same_key}).ok());
  EXPECT_TRUE(store->Load()->empty());
  // The store still works after the error.
  EXPECT_TRUE(store->Save({SessionRecordOf("a")}).ok());
}

TEST_F(SqliteSessionStoreTest, ManyRecordsAreOneTransaction) {
  std::vector<SessionRecord> records;
  for (int i = 1000; i < 3000; ++i) records.push_back(SessionRecordOf(std::to_string(i)));
  ASSERT_TRUE(Open()->Save(records).ok());
  EXPECT_EQ(Loaded(), records);
}

TEST_F(SqliteSessionStoreTest, MarksThatCannotBeReadAreLeftOut) {
  ASSERT_TRUE(Open()->Save({SessionRecordOf("a"), SessionRecordOf("b")}).ok());
  Execute(path_, "UPDATE marks SET marks = x'0102' WHERE session_id = 'a'");
  SessionRecord without_marks = SessionRecordOf("a");
  without_marks.marks.clear();
  EXPECT_THAT(Loaded(), ElementsAre(without_marks, SessionRecordOf("b")));
}

TEST_F(SqliteSessionStoreTest, OnlyThisUserReadsItsFiles) {
  std::ofstream(path_).flush();
  std::filesystem::permissions(path_, std::filesystem::perms(0644));
  const auto store = Open();
  ASSERT_TRUE(store->Save({SessionRecordOf("a")}).ok());
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_.Path())) {
    EXPECT_EQ(file.status().permissions(), std::filesystem::perms(0600)) << file.path();
    ++files;
  }
  EXPECT_EQ(files, 2) << "the file and the lock";
}

TEST_F(SqliteSessionStoreTest, WhatWasSavedOutlivesAKilledProcess) {
  int saved[2];
  ASSERT_EQ(pipe(saved), 0);
  const pid_t child = fork();
  if (child == 0) {
    auto store = SqliteSessionStore::Open(path_);
    const bool done = store.ok() && (*store)->Save({SessionRecordOf("a")}).ok();
    (void)!write(saved[1], done ? "y" : "n", 1);
    pause();
  }
  char done = 0;
  ASSERT_EQ(read(saved[0], &done, 1), 1);
  EXPECT_EQ(done, 'y');
  // Another process has the file open meanwhile.
  const absl::Status refusal = Refusal();
  EXPECT_EQ(refusal.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(refusal.message()),
              AllOf(HasSubstr("held by another process"), HasSubstr("its own state folder")));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_THAT(Loaded(), ElementsAre(SessionRecordOf("a")));
}

TEST_F(SqliteSessionStoreTest, ANewerVersionIsRefusedAndLeftAsItIs) {
  ASSERT_TRUE(Open()->Save({SessionRecordOf("a")}).ok());
  Execute(path_, "PRAGMA user_version = 8");
  const absl::Status refusal = Refusal();
  EXPECT_EQ(refusal.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(refusal.message()),
              HasSubstr("newer Thunderhead (version 8; this one knows 7)"));
  Execute(path_, "PRAGMA user_version = 7");
  EXPECT_THAT(Loaded(), ElementsAre(SessionRecordOf("a")));
}

TEST_F(SqliteSessionStoreTest, AnotherProgramsDatabaseIsRefused) {
  Execute(path_, "CREATE TABLE bookmarks (url TEXT)");
  EXPECT_THAT(std::string(Refusal().message()), HasSubstr("belongs to another program"));
}

TEST_F(SqliteSessionStoreTest, ADamagedFileIsNamedWithTheRemedy) {
  std::ofstream(path_) << std::string(8192, 'x');
  const absl::Status refusal = Refusal();
  EXPECT_EQ(refusal.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(refusal.message()),
              AllOf(HasSubstr("is damaged"), HasSubstr("move it away")));
}

TEST_F(SqliteSessionStoreTest, DamageInTheMiddleIsFoundAtOnce) {
  ASSERT_TRUE(Open()->Save({SessionRecordOf("a")}).ok());
  std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
  ASSERT_GT(std::filesystem::file_size(path_), 8192U);
  file.seekp(4096);
  file << std::string(4096, '\xff');
  file.close();
  EXPECT_EQ(Refusal().code(), absl::StatusCode::kDataLoss);
}

TEST_F(SqliteSessionStoreTest, AFolderThatIsNotThereIsNamed) {
  const std::string path = folder_.File("none/sessions.db");
  EXPECT_THAT(std::string(SqliteSessionStore::Open(path).status().message()), HasSubstr(path));
}

TEST(MarkBytesTest, CutBytesAreAnError) {
  const std::string whole = store::ToBytes(SessionRecordOf("a").marks);
  std::vector<session::Mark> without_texts = SessionRecordOf("a").marks;
  for (session::Mark& mark : without_texts) {
    mark.owner_key.clear();
    mark.domain.clear();
  }
  ASSERT_EQ(*store::MarksFrom(whole), without_texts);
  int accepted = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    accepted += store::MarksFrom(whole.substr(0, size)).ok() ? 1 : 0;
  }
  EXPECT_EQ(accepted, 2) << "nothing, and the first mark alone";
  std::string long_one = whole;
  long_one[5 * 8 + 7] = '\x7f';  // damages the number of positions
  EXPECT_FALSE(store::MarksFrom(long_one).ok());
}

}  // namespace
}  // namespace thunderhead::testing
