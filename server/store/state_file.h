// The single SQLite file of a server's state. Only this process uses it while it is open. Saved
// data survives the end of the process.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "store/file_lock.h"
#include "store/sqlite.h"

namespace thunderhead::store {

// What a loss of power may cost. The end of the process costs nothing.
enum class Durability {
  kSoon,    // may lose the last seconds
  kAtOnce,  // loses nothing; each transaction costs an fsync
};

class StateFile {
 public:
  // Creates the file, accessible only to this user, or updates the tables of an older version.
  // FAILED_PRECONDITION, naming the file and the remedy, if another process has it open, or if it
  // has a newer version or belongs to another program. DATA_LOSS if it is damaged.
  static absl::StatusOr<std::shared_ptr<StateFile>> Open(const std::string& path);

  // Opens a connection. Each thread that uses the file needs its own, which must not outlive this
  // object.
  absl::StatusOr<Database> Connect(Durability durability) const;

 private:
  StateFile(std::string path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}

  const std::string path_;
  const FileLock lock_;
};

}  // namespace thunderhead::store
