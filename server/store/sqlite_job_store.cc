#include "store/sqlite_job_store.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/log.h"
#include "base/status.h"
#include "store/sqlite.h"
#include "store/times.h"

namespace thunderhead::store {
namespace {

using jobs::ImageRecord;
using jobs::JobRecord;
using jobs::PictureState;

constexpr char kAddJob[] =
    "INSERT INTO jobs (id, result_key, owner, label, created_ms, ended_ms, cancelled) "
    "VALUES (?, ?, ?, ?, ?, ?, ?)";
constexpr char kAddPicture[] =
    "INSERT INTO job_pictures (state, attempts, code, reason, message, bytes, sha256, extension, "
    "milliseconds, drawn_ms, fetched, job_id, place, name, request, valid_time) "
    "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)";
constexpr char kSaveJob[] = "UPDATE jobs SET ended_ms = ?, cancelled = ? WHERE id = ?";
constexpr char kSavePicture[] =
    "UPDATE job_pictures SET state = ?, attempts = ?, code = ?, reason = ?, message = ?, "
    "bytes = ?, sha256 = ?, extension = ?, milliseconds = ?, drawn_ms = ?, fetched = ? "
    "WHERE job_id = ? AND place = ?";
constexpr char kLoadJobs[] =
    "SELECT id, result_key, owner, label, created_ms, ended_ms, cancelled FROM jobs "
    "ORDER BY created_ms, id";
constexpr char kLoadPictures[] =
    "SELECT state, attempts, code, reason, message, bytes, sha256, extension, milliseconds, "
    "drawn_ms, fetched, job_id, place, name, request, valid_time FROM job_pictures "
    "ORDER BY job_id, place";

// The number of columns (and parameters) with a picture's state. They precede the parameters that
// identify the picture.
constexpr int kStateColumns = 11;

// The number by which the tables store each state. It does not depend on the values of the
// enumeration.
constexpr std::array kStates = {
    std::pair{std::int64_t{0}, PictureState::kWaiting},
    std::pair{std::int64_t{0}, PictureState::kDrawing},
    std::pair{std::int64_t{1}, PictureState::kDrawn},
    std::pair{std::int64_t{2}, PictureState::kFailed},
    std::pair{std::int64_t{3}, PictureState::kCancelled},
    std::pair{std::int64_t{4}, PictureState::kDropped},
};

std::int64_t NumberOf(PictureState state) {
  for (const auto& [number, known] : kStates) {
    if (known == state) return number;
  }
  return 0;
}

std::optional<PictureState> StateOf(std::int64_t number) {
  for (const auto& [known, state] : kStates) {
    if (known == number) return state;
  }
  return std::nullopt;
}

void BindState(const ImageRecord& picture, Statement& statement) {
  statement.Bind(1, NumberOf(picture.state));
  statement.Bind(2, std::int64_t{picture.attempts});
  statement.Bind(3, static_cast<std::int64_t>(picture.problem.code));
  statement.Bind(4, picture.problem.reason);
  statement.Bind(5, picture.problem.message);
  statement.Bind(6, static_cast<std::int64_t>(picture.bytes));
  statement.Bind(7, picture.sha256);
  statement.Bind(8, picture.extension);
  statement.Bind(9, picture.milliseconds);
  statement.Bind(10, MillisecondsOf(picture.drawn_at));
  statement.Bind(11, std::int64_t{picture.fetched});
}

void BindEnd(const std::optional<jobs::Time>& ended_at, int parameter, Statement& statement) {
  if (ended_at.has_value()) {
    statement.Bind(parameter, MillisecondsOf(*ended_at));
  } else {
    statement.BindNull(parameter);
  }
}

absl::StatusOr<ImageRecord> PictureOf(const Statement& row) {
  const std::optional<PictureState> state = StateOf(row.Number(0));
  if (!state.has_value()) {
    return absl::DataLossError(absl::StrCat("a picture has the unknown state ", row.Number(0)));
  }
  ImageRecord picture;
  picture.state = *state;
  picture.attempts = static_cast<int>(row.Number(1));
  picture.problem = {static_cast<absl::StatusCode>(row.Number(2)), row.Bytes(3), row.Bytes(4)};
  picture.bytes = static_cast<std::uint64_t>(row.Number(5));
  picture.sha256 = row.Bytes(6);
  picture.extension = row.Bytes(7);
  picture.milliseconds = row.Real(8);
  // The extension is part of the name of the picture's file. That file is removed with the picture,
  // so a damaged extension could name a file that must not be removed.
  if (picture.extension.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789") !=
      std::string::npos) {
    return absl::DataLossError(
        "the file extension of a picture has characters other than a-z and 0-9");
  }
  picture.drawn_at = TimeOf(row.Number(9));
  picture.fetched = row.Number(10) != 0;
  picture.order = {row.Bytes(13), row.Bytes(14), row.Bytes(15)};
  return picture;
}

JobRecord JobOf(const Statement& row) {
  JobRecord job;
  job.id = row.Bytes(0);
  job.result_key = row.Bytes(1);
  job.owner = row.Bytes(2);
  job.label = row.Bytes(3);
  job.created_at = TimeOf(row.Number(4));
  if (!row.IsNull(5)) job.ended_at = TimeOf(row.Number(5));
  job.cancelled = row.Number(6) != 0;
  return job;
}

class OpenJobStore final : public SqliteJobStore {
 public:
  explicit OpenJobStore(Connection connection) : connection_(std::move(connection)) {}

  absl::Status Add(const JobRecord& job) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(Database* const database, connection_.Use());
    THUNDERHEAD_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*database));
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement add, database->Prepare(kAddJob));
    add.Bind(1, job.id);
    add.Bind(2, job.result_key);
    add.Bind(3, job.owner);
    add.Bind(4, job.label);
    add.Bind(5, MillisecondsOf(job.created_at));
    BindEnd(job.ended_at, 6, add);
    add.Bind(7, std::int64_t{job.cancelled});
    THUNDERHEAD_RETURN_IF_ERROR(add.Run());
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement add_picture, database->Prepare(kAddPicture));
    for (std::size_t i = 0; i < job.pictures.size(); ++i) {
      const ImageRecord& picture = job.pictures[i];
      BindState(picture, add_picture);
      add_picture.Bind(kStateColumns + 1, job.id);
      add_picture.Bind(kStateColumns + 2, static_cast<std::int64_t>(i));
      add_picture.Bind(kStateColumns + 3, picture.order.name);
      add_picture.BindBlob(kStateColumns + 4, picture.order.request);
      add_picture.Bind(kStateColumns + 5, picture.order.valid_time);
      THUNDERHEAD_RETURN_IF_ERROR(add_picture.Run());
    }
    return transaction.Commit();
  }

  absl::Status Save(const std::vector<jobs::JobChange>& changes) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(Database* const database, connection_.Use());
    THUNDERHEAD_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*database));
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement save, database->Prepare(kSaveJob));
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement save_picture, database->Prepare(kSavePicture));
    for (const jobs::JobChange& change : changes) {
      BindEnd(change.ended_at, 1, save);
      save.Bind(2, std::int64_t{change.cancelled});
      save.Bind(3, change.id);
      THUNDERHEAD_RETURN_IF_ERROR(save.Run());
      for (const jobs::JobChange::Picture& picture : change.pictures) {
        BindState(picture.record, save_picture);
        save_picture.Bind(kStateColumns + 1, change.id);
        save_picture.Bind(kStateColumns + 2, static_cast<std::int64_t>(picture.place));
        THUNDERHEAD_RETURN_IF_ERROR(save_picture.Run());
      }
    }
    return transaction.Commit();
  }

  absl::Status Remove(const std::vector<std::string>& ids) override {
    THUNDERHEAD_ASSIGN_OR_RETURN(Database* const database, connection_.Use());
    THUNDERHEAD_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*database));
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement remove,
                                 database->Prepare("DELETE FROM jobs WHERE id = ?"));
    for (const std::string& id : ids) {
      remove.Bind(1, id);
      THUNDERHEAD_RETURN_IF_ERROR(remove.Run());
    }
    return transaction.Commit();
  }

  absl::StatusOr<std::vector<JobRecord>> Load() override {
    std::vector<JobRecord> records;
    std::map<std::string, std::size_t> index_by_id;
    THUNDERHEAD_ASSIGN_OR_RETURN(Database* const database, connection_.Use());
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement rows, database->Prepare(kLoadJobs));
    while (true) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, rows.Next());
      if (!found) break;
      records.push_back(JobOf(rows));
      // The id is the name of the folder with the job's results. That folder is removed with the
      // job, so a damaged id could name a folder that must not be removed.
      if (!jobs::IsJobId(records.back().id)) {
        return DamagedFile(connection_.Path(),
                           "the id of a render job does not have the form of an id");
      }
      index_by_id[records.back().id] = records.size() - 1;
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(Statement pictures, database->Prepare(kLoadPictures));
    while (true) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, pictures.Next());
      if (!found) break;
      const auto index = index_by_id.find(pictures.Bytes(kStateColumns));
      if (index == index_by_id.end()) {
        return DamagedFile(connection_.Path(), "a picture belongs to no render job");
      }
      JobRecord& job = records[index->second];
      // Clients identify pictures by their places, so a gap would give them other pictures.
      if (pictures.Number(kStateColumns + 1) != static_cast<std::int64_t>(job.pictures.size())) {
        return DamagedFile(
            connection_.Path(),
            absl::StrCat("render job ", job.id, " lacks picture ", job.pictures.size()));
      }
      absl::StatusOr<ImageRecord> picture = PictureOf(pictures);
      if (!picture.ok()) {
        // An unreadable picture is replaced by a failed picture and not left out, because clients
        // identify pictures by their places.
        base::LogError(base::Annotate(picture.status(), absl::StrCat("render job ", job.id)));
        picture.emplace();
        picture->state = PictureState::kFailed;
        picture->problem = {absl::StatusCode::kDataLoss, "DATA_LOSS",
                            "the server's record of this picture is damaged"};
      }
      job.pictures.push_back(*std::move(picture));
    }
    for (const JobRecord& job : records) {
      if (!job.pictures.empty()) continue;
      return DamagedFile(connection_.Path(),
                         absl::StrCat("render job ", job.id, " lacks its pictures"));
    }
    return records;
  }

 private:
  Connection connection_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteJobStore>> SqliteJobStore::In(
    std::shared_ptr<StateFile> file) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Connection connection, Connection::Open(std::move(file)));
  return std::make_unique<OpenJobStore>(std::move(connection));
}

}  // namespace thunderhead::store
