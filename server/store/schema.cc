#include "store/schema.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::store {
namespace {

// "Thun" in ASCII. It distinguishes our files from other programs'.
constexpr std::int64_t kApplicationId = 0x5468756e;

// The SQL of the migration steps. Step n migrates version n of the schema to version n + 1. A step
// must not be changed after its release. Marks have a separate table, because a session is saved at
// every movement of the camera, and its marks need not be written each time.
constexpr std::array kSteps = {R"(
  CREATE TABLE sessions (
    id TEXT PRIMARY KEY NOT NULL,
    presenter_key TEXT UNIQUE NOT NULL,
    viewer_key TEXT UNIQUE NOT NULL,
    viewers_may_steer INTEGER NOT NULL,
    control_locked INTEGER NOT NULL,
    following_locked INTEGER NOT NULL,
    viewers_may_mark INTEGER NOT NULL,
    free_when_away INTEGER NOT NULL,
    scene BLOB NOT NULL,
    scene_revision INTEGER NOT NULL,
    last_used_ms INTEGER NOT NULL  -- since 1970
  ) STRICT;
  CREATE TABLE marks (
    session_id TEXT PRIMARY KEY NOT NULL REFERENCES sessions ON DELETE CASCADE,
    marks BLOB NOT NULL  -- mark_bytes.h
  ) STRICT;
)",
                               R"(
  CREATE TABLE jobs (
    id TEXT PRIMARY KEY NOT NULL,
    result_key TEXT UNIQUE NOT NULL,
    owner TEXT NOT NULL,
    label TEXT NOT NULL,
    created_ms INTEGER NOT NULL,  -- since 1970
    ended_ms INTEGER,
    cancelled INTEGER NOT NULL
  ) STRICT;
  CREATE TABLE job_pictures (
    job_id TEXT NOT NULL REFERENCES jobs ON DELETE CASCADE,
    place INTEGER NOT NULL,
    name TEXT NOT NULL,
    request BLOB NOT NULL,
    valid_time TEXT NOT NULL,
    state INTEGER NOT NULL,  -- sqlite_job_store.cc
    attempts INTEGER NOT NULL,
    code INTEGER NOT NULL,  -- as in absl::StatusCode
    reason TEXT NOT NULL,
    message TEXT NOT NULL,
    bytes INTEGER NOT NULL,
    sha256 TEXT NOT NULL,
    extension TEXT NOT NULL,
    milliseconds REAL NOT NULL,
    drawn_ms INTEGER NOT NULL,  -- since 1970
    fetched INTEGER NOT NULL,
    PRIMARY KEY (job_id, place)
  ) STRICT, WITHOUT ROWID;
)",
                               R"(
  -- A line for each mark, in their order: its owner's key, or nothing.
  ALTER TABLE marks ADD COLUMN owner_keys TEXT NOT NULL DEFAULT '';
)",
                               R"(
  -- The identity that opened it, or nothing.
  ALTER TABLE sessions ADD COLUMN owner TEXT NOT NULL DEFAULT '';
)",
                               R"(
  ALTER TABLE sessions ADD COLUMN control_is_free INTEGER NOT NULL DEFAULT 0;
)",
                               R"(
  -- As owner_keys: the domain of the storm that it lies on, or nothing.
  ALTER TABLE marks ADD COLUMN domains TEXT NOT NULL DEFAULT '';
)",
                               R"(
  -- Of the viewer who steers, or nothing.
  ALTER TABLE sessions ADD COLUMN steering_key TEXT NOT NULL DEFAULT '';
  ALTER TABLE sessions ADD COLUMN steering_name TEXT NOT NULL DEFAULT '';
  ALTER TABLE sessions ADD COLUMN steering_id INTEGER NOT NULL DEFAULT 0;
)"};

absl::Status CheckOrigin(Database& database, const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::int64_t id, database.Number("PRAGMA application_id"));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::int64_t objects,
                               database.Number("SELECT count(*) FROM sqlite_schema"));
  if (id == kApplicationId || (id == 0 && objects == 0)) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(path, " belongs to another program; choose another folder"));
}

// Lists each column of each table.
constexpr char kColumns[] =
    "SELECT m.name || '.' || c.name || ' ' || c.type || ' ' || c.\"notnull\" || ' ' || c.pk "
    "FROM sqlite_schema AS m, pragma_table_info(m.name) AS c WHERE m.type = 'table'";

absl::StatusOr<std::set<std::string>> TextsOf(Database& database, const std::string& query) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Statement rows, database.Prepare(query));
  std::set<std::string> texts;
  while (true) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, rows.Next());
    if (!found) return texts;
    texts.insert(rows.Bytes(0));
  }
}

absl::Status RunSteps(Database& database, std::int64_t version) {
  for (auto step = static_cast<std::size_t>(version); step < kSteps.size(); ++step) {
    THUNDERHEAD_RETURN_IF_ERROR(database.Execute(kSteps[step]));
  }
  return absl::OkStatus();
}

// Checks that the file's tables have all columns of the newest version. Also checks that it has no
// views or triggers, which could change what the SQL of this program does. Tables of other
// programs, for example for backups, may be there.
absl::Status CheckTables(Database& database, const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::set<std::string> foreign,
                               TextsOf(database,
                                       "SELECT type || ' ' || name FROM sqlite_schema "
                                       "WHERE type IN ('view', 'trigger')"));
  if (!foreign.empty()) return DamagedFile(path, absl::StrCat("it has the ", *foreign.begin()));
  THUNDERHEAD_ASSIGN_OR_RETURN(Database empty, Database::Open(Database::kInMemory));
  THUNDERHEAD_RETURN_IF_ERROR(RunSteps(empty, 0));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::set<std::string> wanted, TextsOf(empty, kColumns));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::set<std::string> found, TextsOf(database, kColumns));
  for (const std::string& column : wanted) {
    if (!found.contains(column)) return DamagedFile(path, absl::StrCat("it lacks ", column));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status UpdateSchema(Database& database, const std::string& path) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckOrigin(database, path));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::int64_t version, database.Number("PRAGMA user_version"));
  const std::int64_t newest{kSteps.size()};
  if (version > newest) {
    return absl::FailedPreconditionError(
        absl::StrCat(path, " was written by a newer Thunderhead (version ", version,
                     "; this one knows ", newest, "): start that one, or move the file away"));
  }
  if (version < 0) return DamagedFile(path, absl::StrCat("it has the version ", version));
  THUNDERHEAD_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(database));
  THUNDERHEAD_RETURN_IF_ERROR(RunSteps(database, version));
  THUNDERHEAD_RETURN_IF_ERROR(CheckTables(database, path));
  THUNDERHEAD_RETURN_IF_ERROR(database.Execute(absl::StrCat(
      "PRAGMA application_id = ", kApplicationId, "; PRAGMA user_version = ", newest)));
  return transaction.Commit();
}

}  // namespace thunderhead::store
