// Checks of a folder and of its files that only this user may change. Another user who could write
// the folder could replace its files, or make them lead to files elsewhere.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/file_descriptor.h"

namespace thunderhead::store {

// Checks who may write the existing folder. It must belong to this user or to root, and neither its
// group nor others may write it. There is one exception: if this process does not run as root, a
// group to which it belongs may write a folder of root. Kubernetes prepares volumes in this way
// (fsGroup). Returns FAILED_PRECONDITION with the remedy.
absl::Status CheckFolder(const std::string& folder);

// Checks that the path is a regular file, or that nothing is there. Returns FAILED_PRECONDITION for
// anything else, such as a link, a FIFO or a folder.
absl::Status CheckFile(const std::string& path);

// Opens the file for reading and writing. Creates it, accessible only to this user, if it does not
// exist. Links are not followed. Returns FAILED_PRECONDITION if the path is no regular file or
// cannot be written.
absl::StatusOr<base::FileDescriptor> OpenFile(const std::string& path);

// Identifies a file on this machine for as long as it is open.
struct FileIdentity {
  dev_t device;
  ino_t inode;

  bool operator==(const FileIdentity&) const = default;
};

// Returns the identity of what is at the path, without following a link. Returns nothing if nothing
// is there, and UNAVAILABLE if that cannot be known.
absl::StatusOr<std::optional<FileIdentity>> IdentityAt(const std::string& path);

// Returns the identity of an open file.
FileIdentity IdentityOf(int file);

}  // namespace thunderhead::store
