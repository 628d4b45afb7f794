#include "store/state_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/log.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "store/schema.h"

namespace thunderhead::store {
namespace {

std::string LockPath(const std::string& path) { return absl::StrCat(path, ".lock"); }

// Creates the file, accessible only to this user, before SQLite opens it. SQLite would create it
// with the user's default mode. SQLite gives its other files the mode of this file. Returns the
// file's identity.
absl::StatusOr<FileIdentity> CreateForThisUser(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const base::FileDescriptor file, OpenFile(path));
  if (fchmod(file.Get(), 0600) == 0) return IdentityOf(file.Get());
  return absl::FailedPreconditionError(
      absl::StrCat(path, " cannot be made private: ", std::strerror(errno)));
}

// Checks the other files that SQLite opens with a database. Opening a planted FIFO would never
// return.
absl::Status CheckSqliteFiles(const std::string& path) {
  for (const char* const suffix : {"-journal", "-wal"}) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckFile(absl::StrCat(path, suffix)));
  }
  return absl::OkStatus();
}

absl::Status CheckWhole(Database& database, const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Statement check, database.Prepare("PRAGMA quick_check(1)"));
  THUNDERHEAD_RETURN_IF_ERROR(check.Next().status());
  const std::string found = check.Bytes(0);
  return found == "ok" ? absl::OkStatus() : DamagedFile(path, found);
}

// Brings an existing file to this version. Earlier versions kept a write-ahead log next to the
// file. In the exclusive mode SQLite reads the log without its index file, which may be damaged.
absl::Status Prepare(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Database database, Database::Open(path));
  THUNDERHEAD_RETURN_IF_ERROR(database.Execute("PRAGMA locking_mode = EXCLUSIVE"));
  THUNDERHEAD_RETURN_IF_ERROR(CheckWhole(database, path));
  THUNDERHEAD_RETURN_IF_ERROR(UpdateSchema(database, path));
  THUNDERHEAD_RETURN_IF_ERROR(database.Execute("PRAGMA journal_mode = DELETE"));
  unlink(absl::StrCat(path, "-shm").c_str());
  return absl::OkStatus();
}

// Writes the content of the database to the empty file at `path`.
absl::Status CopyInto(Database& database, const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Statement copy, database.Prepare("VACUUM INTO ?"));
  copy.Bind(1, std::string_view(path));
  return copy.Run();
}

absl::StatusOr<Database> ConnectTo(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Database database, Database::Open(path));
  // With EXTRA, the removal of the journal, which ends a transaction, also survives a loss of
  // power. A journal that stays (PERSIST) would keep SQLite from reading a removed file.
  THUNDERHEAD_RETURN_IF_ERROR(
      database.Execute("PRAGMA synchronous = EXTRA; PRAGMA foreign_keys = ON"));
  return database;
}

}  // namespace

StateFile::StateFile(std::string path, FileLock lock, Database database, FileIdentity identity)
    : path_(std::move(path)),
      lock_(std::move(lock)),
      database_(std::move(database)),
      identity_(identity) {}

absl::StatusOr<std::shared_ptr<StateFile>> StateFile::Open(const std::string& path) {
  // The lock is a separate file because SQLite's own locks would admit a second process between two
  // transactions.
  absl::StatusOr<FileLock> lock = FileLock::Take(LockPath(path));
  if (!lock.ok()) {
    return base::Annotate(lock.status(), "each server needs its own state folder");
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckSqliteFiles(path));
  THUNDERHEAD_ASSIGN_OR_RETURN(const FileIdentity identity, CreateForThisUser(path));
  THUNDERHEAD_RETURN_IF_ERROR(Prepare(path));
  THUNDERHEAD_ASSIGN_OR_RETURN(Database database, ConnectTo(path));
  return std::shared_ptr<StateFile>(
      new StateFile(path, *std::move(lock), std::move(database), identity));
}

absl::StatusOr<Database> StateFile::Connect() const { return ConnectTo(path_); }

absl::StatusOr<int> StateFile::Check() {
  const std::lock_guard guard(mutex_);
  THUNDERHEAD_RETURN_IF_ERROR(CheckLock());
  if (const absl::Status planted = CheckSqliteFiles(path_); !planted.ok()) {
    return absl::UnavailableError(planted.message());
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<FileIdentity> found, IdentityAt(path_));
  if (found == identity_) return times_written_;
  if (found.has_value()) {
    return absl::UnavailableError(absl::StrCat(
        path_,
        " was replaced by another file while the server runs; to use that file, restart the "
        "server; to keep the server's state, move that file away, and the server writes its own "
        "anew"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(WriteAnew());
  base::LogError(absl::DataLossError(
      absl::StrCat(path_, " was removed while the server runs; its content is written anew")));
  return ++times_written_;
}

absl::Status StateFile::CheckLock() {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<FileIdentity> found,
                               IdentityAt(LockPath(path_)));
  if (found == lock_.Identity()) return absl::OkStatus();
  THUNDERHEAD_RETURN_IF_ERROR(CheckOwnFolder());
  absl::StatusOr<FileLock> lock = FileLock::Take(LockPath(path_), std::chrono::milliseconds(0));
  if (!lock.ok()) {
    return base::Annotate(lock.status(),
                          "the lock of the state folder was removed or replaced while the server "
                          "runs, and cannot be taken again");
  }
  lock_ = *std::move(lock);
  base::LogError(absl::FailedPreconditionError(absl::StrCat(
      LockPath(path_), " was removed or replaced while the server runs; it is taken again")));
  return absl::OkStatus();
}

absl::Status StateFile::CheckOwnFolder() const {
  const std::string folder = std::filesystem::path(path_).parent_path().string();
  return CheckFolder(folder.empty() ? "." : folder);
}

absl::Status StateFile::WriteAnew() {
  THUNDERHEAD_RETURN_IF_ERROR(CheckOwnFolder());
  const std::string partial = base::PartialPath(path_);
  unlink(partial.c_str());
  THUNDERHEAD_ASSIGN_OR_RETURN(const FileIdentity identity, CreateForThisUser(partial));
  const absl::Status copied = CopyInto(database_, partial);
  if (absl::IsDataLoss(copied)) {
    return absl::DataLossError(absl::StrCat(
        path_,
        " was removed while the server runs, but was damaged before, so its content cannot be "
        "written anew; restart the server, which then begins without sessions and jobs"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(copied);
  THUNDERHEAD_RETURN_IF_ERROR(base::PublishFile(path_));
  THUNDERHEAD_ASSIGN_OR_RETURN(database_, ConnectTo(path_));
  identity_ = identity;
  return absl::OkStatus();
}

absl::StatusOr<Connection> Connection::Open(std::shared_ptr<StateFile> file) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const int times_written, file->Check());
  THUNDERHEAD_ASSIGN_OR_RETURN(Database database, file->Connect());
  return Connection(std::move(file), std::move(database), times_written);
}

absl::StatusOr<Database*> Connection::Use() {
  THUNDERHEAD_ASSIGN_OR_RETURN(const int times_written, file_->Check());
  if (times_written != times_written_) {
    THUNDERHEAD_ASSIGN_OR_RETURN(database_, file_->Connect());
    times_written_ = times_written;
  }
  return &database_;
}

}  // namespace thunderhead::store
