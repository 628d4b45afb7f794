// The one SQLite file that a server keeps its state in. This process alone uses it while any part
// of it is open; what was saved outlives the end of the process.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "store/file_lock.h"
#include "store/sqlite.h"

namespace thunderhead::store {

// How much of a transaction survives a loss of power; none is lost to the end of the process.
enum class Durability {
  kSoon,    // it may cost the last seconds
  kAtOnce,  // nothing; each costs an fsync
};

class StateFile {
 public:
  // Creates the file, for this user only, or brings the tables of an older version up to date.
  // FAILED_PRECONDITION, naming the file and the remedy, if another process has it open, or it is
  // of a newer version or another program's; DATA_LOSS if it is damaged.
  static absl::StatusOr<std::shared_ptr<StateFile>> Open(const std::string& path);

  // A connection of its own for each thread that uses the file, which must not outlive this.
  absl::StatusOr<Database> Connect(Durability durability) const;

 private:
  StateFile(std::string path, FileLock lock) : path_(std::move(path)), lock_(std::move(lock)) {}

  const std::string path_;
  const FileLock lock_;
};

}  // namespace thunderhead::store
