// A file or folder that one process at a time holds. The system releases it when the process ends,
// however that happens.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"

namespace thunderhead::store {

class FileLock {
 public:
  // Creates the file, for this user only. Waits a moment for a process that is just ending;
  // FAILED_PRECONDITION if it holds the file longer.
  static absl::StatusOr<FileLock> Take(const std::string& path);
  // Of a folder that exists and is this user's, at once; none for any other, or if a process holds
  // it.
  static std::optional<FileLock> TryFolder(const std::string& folder);
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

 private:
  explicit FileLock(int file) : file_(file) {}

  int file_;  // -1: none
};

}  // namespace thunderhead::store
