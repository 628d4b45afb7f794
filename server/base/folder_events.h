// The kernel's word (inotify) that something has happened in some folders. What has happened is
// for a scan to find out: events may be merged, come too often, or be lost, and a network file
// system sends none for what other machines do.
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

  // Watches the folder itself, not those below it; again does no harm. True if it was not watched
  // before. A folder that cannot be watched is logged once for all.
  bool Watch(const std::string& folder);

  // Waits until a file was written and closed, or anything was moved, made or deleted in a watched
  // folder, until Wake, or until `deadline`. True for the first.
  bool WaitUntil(std::chrono::steady_clock::time_point deadline);

  // Ends a WaitUntil, or the next one; from any thread.
  void Wake();

 private:
  bool Drain();

  int events_ = -1;  // inotify's descriptor
  int wake_ = -1;    // eventfd's
  std::map<int, std::string> folders_;
  bool warned_ = false;
};

}  // namespace thunderhead::base
