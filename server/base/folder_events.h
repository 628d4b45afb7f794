// Receives notifications from the kernel (inotify) about changes in folders. The caller must scan
// the folders to find out what has happened. The kernel can merge or lose events, and can send more
// events than there are changes. A network file system sends no events for changes that other
// machines make.
#pragma once

#include <chrono>
#include <map>
#include <string>

namespace thunderhead::base {

class FolderEvents {
 public:
  FolderEvents();
  ~FolderEvents();
  FolderEvents(const FolderEvents&) = delete;
  FolderEvents& operator=(const FolderEvents&) = delete;

  // Watches the folder, but not its subfolders. A repeated call for the same folder does nothing.
  // Returns true if the folder was not watched before. Only the first folder that cannot be watched
  // is logged.
  bool Watch(const std::string& folder);

  // Waits for an event, for Wake or until `deadline`. An event is a file that was written and
  // closed, or anything that was moved, created or deleted in a watched folder. Returns whether
  // there was an event.
  bool WaitUntil(std::chrono::steady_clock::time_point deadline);

  // Ends the current WaitUntil, or the next one. Safe from any thread.
  void Wake();

 private:
  bool Drain();

  int events_ = -1;  // descriptor of inotify
  int wake_ = -1;    // descriptor of the eventfd that Wake writes to
  std::map<int, std::string> folders_;
  bool warned_ = false;
};

}  // namespace thunderhead::base
