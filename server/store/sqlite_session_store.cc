#include "store/sqlite_session_store.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/log.h"
#include "base/status.h"
#include "store/mark_bytes.h"
#include "store/sqlite.h"
#include "store/times.h"
#include "telemetry/metrics.h"

namespace thunderhead::store {
namespace {

using session::SessionRecord;

constexpr char kSaveSession[] =
    "INSERT INTO sessions (id, presenter_key, viewer_key, viewers_may_steer, control_locked, "
    "following_locked, viewers_may_mark, free_when_away, scene, scene_revision, last_used_ms, "
    "owner, control_is_free, steering_key, steering_name, steering_id) "
    "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET "
    "presenter_key = excluded.presenter_key, viewer_key = excluded.viewer_key, "
    "viewers_may_steer = excluded.viewers_may_steer, control_locked = excluded.control_locked, "
    "following_locked = excluded.following_locked, viewers_may_mark = excluded.viewers_may_mark, "
    "free_when_away = excluded.free_when_away, scene = excluded.scene, "
    "scene_revision = excluded.scene_revision, last_used_ms = excluded.last_used_ms, "
    "owner = excluded.owner, control_is_free = excluded.control_is_free, "
    "steering_key = excluded.steering_key, steering_name = excluded.steering_name, "
    "steering_id = excluded.steering_id";
// Writes marks only when they have changed.
constexpr char kSaveMarks[] =
    "INSERT INTO marks (session_id, marks, owner_keys, domains) VALUES (?, ?, ?, ?) "
    "ON CONFLICT (session_id) DO UPDATE SET "
    "marks = excluded.marks, owner_keys = excluded.owner_keys, domains = excluded.domains "
    "WHERE marks IS NOT excluded.marks OR owner_keys IS NOT excluded.owner_keys "
    "OR domains IS NOT excluded.domains";
constexpr char kLoad[] =
    "SELECT id, presenter_key, viewer_key, viewers_may_steer, control_locked, following_locked, "
    "viewers_may_mark, free_when_away, scene, scene_revision, last_used_ms, marks, owner_keys, "
    "owner, control_is_free, domains, steering_key, steering_name, steering_id "
    "FROM sessions "
    "LEFT JOIN marks ON session_id = id ORDER BY id";

// Joins the member `text` of all marks, one line for each mark.
std::string LinesOf(const std::vector<session::Mark>& marks, std::string session::Mark::*text) {
  std::string lines;
  for (const session::Mark& mark : marks) absl::StrAppend(&lines, mark.*text, "\n");
  return lines;
}

// Sets the member `text` of each mark from its line in `lines`. Marks without a line keep an empty
// text.
void SetLines(std::string_view lines, std::string session::Mark::*text,
              std::vector<session::Mark>* marks) {
  for (session::Mark& mark : *marks) {
    const std::size_t end = lines.find('\n');
    if (end == std::string_view::npos) return;
    mark.*text = lines.substr(0, end);
    lines.remove_prefix(end + 1);
  }
}

SessionRecord RecordOf(const Statement& row) {
  SessionRecord record;
  record.id = row.Bytes(0);
  record.keys = {row.Bytes(1), row.Bytes(2)};
  record.rules = {.viewers_may_steer = row.Number(3) != 0,
                  .control_locked = row.Number(4) != 0,
                  .following_locked = row.Number(5) != 0,
                  .viewers_may_mark = row.Number(6) != 0,
                  .free_when_away = row.Number(7) != 0};
  record.scene = row.Bytes(8);
  record.scene_revision = static_cast<std::uint64_t>(row.Number(9));
  record.last_used = TimeOf(row.Number(10));
  record.owner = row.Bytes(13);
  record.control = {.is_free = row.Number(14) != 0,
                    .viewer_key = row.Bytes(16),
                    .viewer_name = row.Bytes(17),
                    .viewer_id = static_cast<std::uint64_t>(row.Number(18))};
  return record;
}

absl::StatusOr<std::vector<session::Mark>> MarksOf(const Statement& row) {
  // Each session is saved together with its marks, even if it has none.
  if (row.IsNull(11)) return absl::DataLossError("its marks are missing");
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<session::Mark> marks, MarksFrom(row.Bytes(11)));
  SetLines(row.Bytes(12), &session::Mark::owner_key, &marks);
  SetLines(row.Bytes(15), &session::Mark::domain, &marks);
  return marks;
}

class OpenSessionStore final : public SqliteSessionStore {
 public:
  explicit OpenSessionStore(Connection connection) : connection_(std::move(connection)) {}

  absl::Status Save(const std::vector<SessionRecord>& records) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(Database* const database, connection_.Use());
    THUNDERHEAD_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*database));
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement save, database->Prepare(kSaveSession));
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement save_marks, database->Prepare(kSaveMarks));
    for (const SessionRecord& record : records) {
      BindAll(record, save);
      THUNDERHEAD_RETURN_IF_ERROR(save.Run());
      const std::string marks = ToBytes(record.marks);
      save_marks.Bind(1, record.id);
      save_marks.BindBlob(2, marks);
      const std::string owner_keys = LinesOf(record.marks, &session::Mark::owner_key);
      const std::string domains = LinesOf(record.marks, &session::Mark::domain);
      save_marks.Bind(3, owner_keys);
      save_marks.Bind(4, domains);
      THUNDERHEAD_RETURN_IF_ERROR(save_marks.Run());
    }
    return transaction.Commit();
  }

  absl::Status Remove(const std::vector<std::string>& ids) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(Database* const database, connection_.Use());
    THUNDERHEAD_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*database));
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement remove,
                                 database->Prepare("DELETE FROM sessions WHERE id = ?"));
    for (const std::string& id : ids) {
      remove.Bind(1, id);
      THUNDERHEAD_RETURN_IF_ERROR(remove.Run());
    }
    return transaction.Commit();
  }

  absl::Status Check() override { return connection_.Use().status(); }

  absl::StatusOr<std::vector<SessionRecord>> Load() override {
    THUNDERHEAD_ASSIGN_OR_RETURN(Database* const database, connection_.Use());
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement rows, database->Prepare(kLoad));
    std::vector<SessionRecord> records;
    while (true) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, rows.Next());
      if (!found) return records;
      SessionRecord record = RecordOf(rows);
      auto marks = MarksOf(rows);
      if (marks.ok()) {
        record.marks = *std::move(marks);
      } else {
        telemetry::Counted().session_damages.Add();
        base::LogError(base::Annotate(
            marks.status(), absl::StrCat("session ", record.id, " is restored without its marks")));
      }
      records.push_back(std::move(record));
    }
  }

 private:
  static void BindAll(const SessionRecord& record, Statement& save) {
    save.Bind(1, record.id);
    save.Bind(2, record.keys.presenter);
    save.Bind(3, record.keys.viewer);
    save.Bind(4, std::int64_t{record.rules.viewers_may_steer});
    save.Bind(5, std::int64_t{record.rules.control_locked});
    save.Bind(6, std::int64_t{record.rules.following_locked});
    save.Bind(7, std::int64_t{record.rules.viewers_may_mark});
    save.Bind(8, std::int64_t{record.rules.free_when_away});
    save.BindBlob(9, record.scene);
    save.Bind(10, static_cast<std::int64_t>(record.scene_revision));
    save.Bind(11, MillisecondsOf(record.last_used));
    save.Bind(12, record.owner);
    save.Bind(13, std::int64_t{record.control.is_free});
    save.Bind(14, record.control.viewer_key);
    save.Bind(15, record.control.viewer_name);
    save.Bind(16, static_cast<std::int64_t>(record.control.viewer_id));
  }

  Connection connection_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteSessionStore>> SqliteSessionStore::Open(
    const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::shared_ptr<StateFile> file, StateFile::Open(path));
  return In(std::move(file));
}

absl::StatusOr<std::unique_ptr<SqliteSessionStore>> SqliteSessionStore::In(
    std::shared_ptr<StateFile> file) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Connection connection, Connection::Open(std::move(file)));
  return std::make_unique<OpenSessionStore>(std::move(connection));
}

}  // namespace thunderhead::store
