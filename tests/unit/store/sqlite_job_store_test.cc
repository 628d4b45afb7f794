// Tests of how render jobs are restored. They also check that a file of sessions from a version
// without render jobs is kept.
#include "store/sqlite_job_store.h"

#include <sqlite3.h>

#include <filesystem>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "store/sqlite_session_store.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::testing {
namespace {

using jobs::ImageRecord;
using jobs::JobRecord;
using jobs::PictureState;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string IdOf(char digit) { return std::string(jobs::kIdDigits, digit); }

// `digit` is repeated to make the job's id.
JobRecord JobRecordOf(char digit, int pictures) {
  JobRecord job;
  job.id = IdOf(digit);
  job.result_key = "key of " + job.id;
  job.owner = "anna";
  job.label = "night \xff";
  job.created_at = jobs::Time(std::chrono::milliseconds(1'700'000'000'123));
  for (int i = 0; i < pictures; ++i) {
    ImageRecord& picture = job.pictures.emplace_back();
    picture.order = {"name " + std::to_string(i), std::string("a\0scene\xff", 8), "2013-05-20"};
  }
  return job;
}

class SqliteJobStoreTest : public ::testing::Test {
 protected:
  std::unique_ptr<store::SqliteJobStore> Open() const {
    auto file = store::StateFile::Open(path_);
    EXPECT_TRUE(file.ok()) << file.status();
    auto opened = store::SqliteJobStore::In(*file);
    EXPECT_TRUE(opened.ok()) << opened.status();
    return *std::move(opened);
  }

  std::vector<JobRecord> Loaded() const {
    const auto records = Open()->Load();
    EXPECT_TRUE(records.ok()) << records.status();
    return records.ok() ? *records : std::vector<JobRecord>();
  }

  // Changes the file as no server does.
  void Execute(const std::string& sql) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }

  // Returns the error of opening the file and loading its jobs.
  absl::Status Complaint() const {
    auto file = store::StateFile::Open(path_);
    if (!file.ok()) return file.status();
    return (*store::SqliteJobStore::In(*file))->Load().status();
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("sessions.db");
};

TEST_F(SqliteJobStoreTest, GivesBackWhatItWasGiven) {
  const JobRecord job = JobRecordOf('a', 3);
  ASSERT_TRUE(Open()->Add(job).ok());
  EXPECT_THAT(Loaded(), ElementsAre(job));
}

TEST_F(SqliteJobStoreTest, KeepsEachStateOfAPictureButThatOfBeingDrawn) {
  JobRecord job = JobRecordOf('a', 3);
  const auto store = Open();
  ASSERT_TRUE(store->Add(job).ok());
  ImageRecord& drawn = job.pictures[0];
  drawn.state = PictureState::kDrawn;
  drawn.attempts = 2;
  drawn.bytes = std::uint64_t{1} << 40;
  drawn.sha256 = "abc";
  drawn.extension = "png";
  drawn.milliseconds = 12.5;
  drawn.drawn_at = job.created_at + std::chrono::seconds(1);
  drawn.fetched = true;
  job.pictures[1].state = PictureState::kFailed;
  job.pictures[1].problem = {absl::StatusCode::kDataLoss, "STORM_UNREADABLE", "cut short"};
  job.pictures[2].state = PictureState::kDrawing;
  job.pictures[2].attempts = 1;
  job.ended_at = job.created_at + std::chrono::minutes(1);
  job.cancelled = true;
  jobs::JobChange change{IdOf('a'), job.ended_at, true, {}};
  for (std::size_t i = 0; i < 3; ++i) change.pictures.push_back({i, job.pictures[i]});
  ASSERT_TRUE(store->Save({change, {"gone", std::nullopt, false, {}}}).ok());
  job.pictures[2].state = PictureState::kWaiting;
  const auto loaded = store->Load();
  ASSERT_TRUE(loaded.ok());
  EXPECT_THAT(*loaded, ElementsAre(job));
}

// Clients identify pictures by their places.
TEST_F(SqliteJobStoreTest, RefusesAJobThatLacksPictures) {
  ASSERT_TRUE(Open()->Add(JobRecordOf('a', 3)).ok());
  ASSERT_TRUE(Open()->Add(JobRecordOf('b', 1)).ok());
  Execute("DELETE FROM job_pictures WHERE place = 1");
  EXPECT_THAT(std::string(Complaint().message()),
              HasSubstr("render job " + IdOf('a') + " lacks picture 1"));
  Execute("DELETE FROM jobs WHERE id LIKE 'a%'; DELETE FROM job_pictures");
  EXPECT_TRUE(absl::IsDataLoss(Complaint()));
  EXPECT_THAT(std::string(Complaint().message()),
              HasSubstr("render job " + IdOf('b') + " lacks its pictures"));
}

TEST_F(SqliteJobStoreTest, RemovesAJobWithItsPictures) {
  const auto store = Open();
  ASSERT_TRUE(store->Add(JobRecordOf('a', 2)).ok());
  ASSERT_TRUE(store->Add(JobRecordOf('b', 2)).ok());
  ASSERT_TRUE(store->Remove({IdOf('a'), "gone"}).ok());
  // Leftover pictures of the removed "a" would conflict with the new job.
  ASSERT_TRUE(store->Add(JobRecordOf('a', 1)).ok());
  EXPECT_THAT(*store->Load(), SizeIs(2));
}

TEST_F(SqliteJobStoreTest, AFileFromBeforeThereWereJobsKeepsItsSessions) {
  {
    auto sessions = store::SqliteSessionStore::Open(path_);
    ASSERT_TRUE(sessions.ok());
    session::SessionRecord record;
    record.id = "one";
    record.keys = {"p", "v"};
    record.scene = "scene";
    record.scene_revision = 7;
    ASSERT_TRUE((*sessions)->Save({record}).ok());
  }
  Execute(
      "DROP TABLE job_pictures; DROP TABLE jobs; "
      "ALTER TABLE marks DROP COLUMN owner_keys; "
      "ALTER TABLE marks DROP COLUMN domains; "
      "ALTER TABLE sessions DROP COLUMN steering_key; "
      "ALTER TABLE sessions DROP COLUMN steering_name; "
      "ALTER TABLE sessions DROP COLUMN steering_id; "
      "ALTER TABLE sessions DROP COLUMN control_is_free; "
      "ALTER TABLE sessions DROP COLUMN owner; PRAGMA user_version = 1");
  auto file = store::StateFile::Open(path_);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto sessions = store::SqliteSessionStore::In(*file);
  const auto jobs = store::SqliteJobStore::In(*file);
  EXPECT_THAT(*(*sessions)->Load(), SizeIs(1));
  EXPECT_THAT(*(*jobs)->Load(), IsEmpty());
  EXPECT_TRUE((*jobs)->Add(JobRecordOf('a', 1)).ok());
  session::SessionRecord record;
  record.id = "two";
  record.keys = {"p2", "v2"};
  EXPECT_TRUE((*sessions)->Save({record}).ok()) << "both use the file at a time";
}

TEST_F(SqliteJobStoreTest, ADamagedRecordIsReportedAsDamage) {
  constexpr char kViewInPlaceOfMarks[] =
      "DROP TABLE marks; CREATE VIEW marks AS SELECT id AS session_id, x'' AS marks, "
      "'' AS owner_keys, '' AS domains FROM sessions";
  for (const char* const sql : {
           kViewInPlaceOfMarks,
           "DELETE FROM jobs",
           "UPDATE jobs SET id = '../../x'; UPDATE job_pictures SET job_id = '../../x'",
           "UPDATE jobs SET id = ''; UPDATE job_pictures SET job_id = ''",
           "DROP TABLE marks",
           "DROP TABLE jobs",
           "ALTER TABLE sessions DROP COLUMN owner",
           "CREATE TRIGGER t AFTER UPDATE ON jobs BEGIN SELECT RAISE(ABORT, 'no'); END",
           "PRAGMA user_version = -5",
           "PRAGMA user_version = 1",
           "PRAGMA user_version = 0",
       }) {
    std::filesystem::remove(path_);
    ASSERT_TRUE(Open()->Add(JobRecordOf('a', 2)).ok());
    ASSERT_TRUE(Complaint().ok());
    Execute(sql);
    const absl::Status complaint = Complaint();
    EXPECT_TRUE(absl::IsDataLoss(complaint)) << sql << ": " << complaint;
    EXPECT_THAT(std::string(complaint.message()), HasSubstr("sessions.db is damaged")) << sql;
    EXPECT_THAT(std::string(complaint.message()), HasSubstr("move it away")) << sql;
  }
}

TEST_F(SqliteJobStoreTest, TablesOfOtherProgramsAreLeftAlone) {
  ASSERT_TRUE(Open()->Add(JobRecordOf('a', 2)).ok());
  Execute("CREATE TABLE backups (done INTEGER); CREATE INDEX owners ON jobs (owner); ANALYZE");
  EXPECT_THAT(Loaded(), SizeIs(1));
}

TEST_F(SqliteJobStoreTest, AnExtensionThatIsAPathFailsItsPicture) {
  ASSERT_TRUE(Open()->Add(JobRecordOf('a', 2)).ok());
  Execute("UPDATE job_pictures SET extension = '../../victim' WHERE place = 1");
  const auto loaded = Loaded();
  ASSERT_THAT(loaded, SizeIs(1));
  EXPECT_EQ(loaded[0].pictures[0].state, PictureState::kWaiting);
  EXPECT_EQ(loaded[0].pictures[1].state, PictureState::kFailed);
  EXPECT_EQ(loaded[0].pictures[1].extension, "");
}

}  // namespace
}  // namespace thunderhead::testing
