// The SQLite file that holds a server's state (sessions and jobs). While it is open, no other
// process can open it. Saved data survive the end of the process.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "store/file_lock.h"
#include "store/sqlite.h"

namespace thunderhead::store {

// How much saved data a loss of power may lose. The end of the process loses no saved data.
enum class Durability {
  kSoon,    // a loss of power may lose the changes of the last seconds
  kAtOnce,  // a loss of power loses no change; each transaction costs an fsync
};

class StateFile {
 public:
  // Creates the file, accessible only to this user, or updates the tables of an older version.
  // Returns FAILED_PRECONDITION, with the file and instructions, in three cases: another process
  // has opened the file, the file has a newer version, or it belongs to another program. Returns
  // DATA_LOSS if the file is damaged.
  static absl::StatusOr<std::shared_ptr<StateFile>> Open(const std::string& path);

  // Opens a connection. Each thread that uses the file needs its own, which must not outlive this
  // object.
  absl::StatusOr<Database> Connect(Durability durability) const;

  const std::string& Path() const { return path_; }

 private:
  StateFile(std::string path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}

  const std::string path_;
  const FileLock lock_;
};

}  // namespace thunderhead::store
