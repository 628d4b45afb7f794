// A lock on a file or folder, held by one process at a time. The system releases it when the
// process ends for any reason.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::store {

class FileLock {
 public:
  // Creates and locks the file, accessible only to this user. Waits briefly for a process that is
  // just ending. FAILED_PRECONDITION if another process holds the file for longer.
  static absl::StatusOr<FileLock> Take(const std::string& path);
  // Locks an existing folder of this user without waiting. None if the folder belongs to another
  // user, does not exist or is locked.
  static std::optional<FileLock> TryFolder(const std::string& folder);
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

 private:
  explicit FileLock(int file) : file_(file) {}

  int file_;  // -1: none
};

}  // namespace thunderhead::store
