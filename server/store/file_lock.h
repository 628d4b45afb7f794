// A lock on a file or folder, held by one process at a time. The system releases it when the
// process ends for any reason.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::store {

class FileLock {
 public:
  // Creates the file at `path`, accessible only to this user, and locks it. Waits up to two
  // seconds, in case another process that holds the lock is just ending. Returns
  // FAILED_PRECONDITION if the other process holds the lock for longer.
  static absl::StatusOr<FileLock> Take(const std::string& path);
  // Locks an existing folder of this user without waiting. Returns nothing if the folder belongs to
  // another user, does not exist or is already locked.
  static std::optional<FileLock> TryFolder(const std::string& folder);
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

 private:
  explicit FileLock(int file) : file_(file) {}

  int file_;  // the locked file's descriptor, or -1 after a move
};

}  // namespace thunderhead::store
