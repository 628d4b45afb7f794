// Tells that something happened in a folder. Events of the file system wake at once; where they do
// not come (network file systems), the caller looks again after the time that it gave.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace thunderhead::pipeline {

class FolderWatch {
 public:
  // NOT_FOUND if there is no such folder. A folder that cannot be watched is only looked at.
  static absl::StatusOr<FolderWatch> Open(const std::string& folder);
  FolderWatch(FolderWatch&& other) noexcept;
  FolderWatch& operator=(FolderWatch&&) = delete;
  ~FolderWatch();

  // Returns after an event since the last call, after Wake, or after `longest`. Files that are
  // written to count as events when they are closed.
  void Wait(absl::Duration longest);

  // Ends a Wait, also a later one. From any thread.
  void Wake() const;

 private:
  FolderWatch(int events, int wake) : events_(events), wake_(wake) {}

  int events_;  // inotify; -1: none
  int wake_;    // eventfd
};

}  // namespace thunderhead::pipeline
