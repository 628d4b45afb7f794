// The SQLite file that holds a server's state (sessions and jobs). While it is open, no other
// server can open it. Saved data survive the end of the process and a loss of power.
//
// A rollback journal is used, and not a write-ahead log. With a log, SQLite maps an index file into
// memory, and truncating that file ends the process (SIGBUS). The log could also be removed
// while it holds saved data.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "store/file_lock.h"
#include "store/private_files.h"
#include "store/sqlite.h"

namespace thunderhead::store {

class StateFile {
 public:
  // Creates the file, accessible only to this user, or updates the tables of an older version.
  // Returns FAILED_PRECONDITION, with the file and instructions, if another process has opened the
  // file, or if it has a newer version. It returns the same error if the file belongs to another
  // program or is no regular file. Returns DATA_LOSS if the file is damaged.
  static absl::StatusOr<std::shared_ptr<StateFile>> Open(const std::string& path);

  // Opens a connection. Each thread that uses the file needs its own.
  absl::StatusOr<Database> Connect() const;

  // Checks that the file is still at its path, and locked there. If the file was removed, writes
  // its content anew. If the lock was removed, takes it again. Both are logged. Returns how many
  // times the file was written anew, after which connections must be opened again. Returns
  // UNAVAILABLE if another file is in its place, or if something else than a regular file is in
  // place of SQLite's journal. Returns FAILED_PRECONDITION if another process has taken the lock or
  // the folder cannot be written. Safe from any thread.
  absl::StatusOr<int> Check();

  const std::string& Path() const { return path_; }

 private:
  StateFile(std::string path, FileLock lock, Database database, FileIdentity identity);
  absl::Status CheckLock();
  // Returns an error if another user could change what this object writes to the folder.
  absl::Status CheckOwnFolder() const;
  absl::Status WriteAnew();

  const std::string path_;
  std::mutex mutex_;  // guards the members below
  FileLock lock_;
  // An idle connection. It still reads the file after its name was removed.
  Database database_;
  FileIdentity identity_;
  int times_written_ = 0;
};

// One thread's connection to the state file.
class Connection {
 public:
  // Opens a connection. Errors are those of StateFile::Check, or of opening the database.
  static absl::StatusOr<Connection> Open(std::shared_ptr<StateFile> file);

  // Returns the database for one transaction, after StateFile::Check, whose errors it returns.
  absl::StatusOr<Database*> Use();

  const std::string& Path() const { return file_->Path(); }

 private:
  Connection(std::shared_ptr<StateFile> file, Database database, int times_written)
      : file_(std::move(file)), database_(std::move(database)), times_written_(times_written) {}

  std::shared_ptr<StateFile> file_;
  Database database_;
  int times_written_;  // the result of StateFile::Check when the database was opened
};

}  // namespace thunderhead::store
