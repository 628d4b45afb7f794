#include "store/state_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "store/schema.h"

namespace thunderhead::store {
namespace {

// Creates the file, accessible only to this user, before SQLite opens it. SQLite would create it
// with the user's default mode. SQLite gives its other files the mode of this file.
absl::Status CreateForThisUser(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  const bool done = file >= 0 && fchmod(file, 0600) == 0;
  const std::string why = std::strerror(errno);
  if (file >= 0) close(file);
  if (done) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(path, " cannot be written: ", why));
}

absl::Status CheckWhole(Database& database, const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Statement check, database.Prepare("PRAGMA quick_check(1)"));
  THUNDERHEAD_RETURN_IF_ERROR(check.Next().status());
  const std::string found = check.Bytes(0);
  return found == "ok" ? absl::OkStatus() : DamagedFile(path, found);
}

}  // namespace

absl::StatusOr<std::shared_ptr<StateFile>> StateFile::Open(const std::string& path) {
  // The lock is a separate file because SQLite's own locks would let a second process in between
  // two transactions.
  absl::StatusOr<FileLock> lock = FileLock::Take(absl::StrCat(path, ".lock"));
  if (!lock.ok()) {
    return base::Annotate(lock.status(), "each server needs its own state folder");
  }
  THUNDERHEAD_RETURN_IF_ERROR(CreateForThisUser(path));
  THUNDERHEAD_ASSIGN_OR_RETURN(Database database, Database::Open(path));
  THUNDERHEAD_RETURN_IF_ERROR(CheckWhole(database, path));
  THUNDERHEAD_RETURN_IF_ERROR(UpdateSchema(database, path));
  return std::shared_ptr<StateFile>(new StateFile(path, *std::move(lock)));
}

absl::StatusOr<Database> StateFile::Connect(Durability durability) const {
  THUNDERHEAD_ASSIGN_OR_RETURN(Database database, Database::Open(path_));
  THUNDERHEAD_RETURN_IF_ERROR(database.Execute(absl::StrCat(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = ",
      durability == Durability::kAtOnce ? "FULL" : "NORMAL", "; PRAGMA foreign_keys = ON")));
  return database;
}

}  // namespace thunderhead::store
