// A lock on a file or folder, held by one process at a time. The system releases it when the
// process ends for any reason.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"
#include "store/private_files.h"

namespace thunderhead::store {

class FileLock {
 public:
  // Maximum time for which Take waits, in case another process that holds the lock is just ending.
  static constexpr std::chrono::milliseconds kPatience{2000};

  // Creates the file at `path`, accessible only to this user, and locks it. Returns
  // FAILED_PRECONDITION if another process holds the lock for longer than `patience`, or if the
  // file cannot be created or written.
  static absl::StatusOr<FileLock> Take(const std::string& path,
                                       std::chrono::milliseconds patience = kPatience);
  // Locks an existing folder of this user without waiting. Returns nothing if the folder belongs to
  // another user, does not exist or is already locked.
  static std::optional<FileLock> TryFolder(const std::string& folder);

  // Returns the identity of the locked file. If another file is at its path, other processes no
  // longer see this lock.
  FileIdentity Identity() const { return IdentityOf(file_.Get()); }

 private:
  explicit FileLock(base::FileDescriptor file) : file_(std::move(file)) {}

  base::FileDescriptor file_;
};

}  // namespace thunderhead::store
