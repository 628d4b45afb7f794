#include "base/folder_events.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "spdlog/spdlog.h"

namespace thunderhead::base {
namespace {

// IN_MODIFY is left out, because a file that is being written would wake the watcher at every
// block.
constexpr std::uint32_t kEvents = IN_CLOSE_WRITE | IN_MOVED_TO | IN_MOVED_FROM | IN_CREATE |
                                  IN_DELETE | IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;

}  // namespace

FolderEvents::FolderEvents()
    : events_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)),
      wake_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (events_ < 0) {
    spdlog::warn("the kernel does not report new files ({}): they are found by a slower search",
                 strerror(errno));
  }
}

FolderEvents::~FolderEvents() {
  if (events_ >= 0) close(events_);
  if (wake_ >= 0) close(wake_);
}

bool FolderEvents::Watch(const std::string& folder) {
  if (events_ < 0) return false;
  const int watch = inotify_add_watch(events_, folder.c_str(), kEvents);
  if (watch >= 0) return folders_.insert_or_assign(watch, folder).second;
  if (!warned_ && errno != ENOENT) {
    warned_ = true;
    spdlog::warn(
        "the kernel does not report new files in {} ({}): they are found by a slower search; raise "
        "fs.inotify.max_user_watches if its limit is reached",
        folder, strerror(errno));
  }
  return false;
}

bool FolderEvents::WaitUntil(std::chrono::steady_clock::time_point deadline) {
  std::array<pollfd, 2> polled{{{wake_, POLLIN, 0}, {events_, POLLIN, 0}}};
  while (true) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    const auto wait_ms = std::clamp<std::int64_t>(left.count(), 0, 3'600'000);
    const int ready = poll(polled.data(), polled.size(), static_cast<int>(wait_ms));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    if ((polled[0].revents & POLLIN) != 0) {
      std::uint64_t count = 0;
      static_cast<void>(read(wake_, &count, sizeof count));
      return false;
    }
    if (Drain()) return true;
  }
}

// Reads all available data from the descriptor. Returns whether there was any.
bool FolderEvents::Drain() {
  alignas(inotify_event) std::array<char, 16 * 1024> buffer{};
  bool any = false;
  for (ssize_t bytes = 0; (bytes = read(events_, buffer.data(), buffer.size())) > 0;) {
    any = true;
    for (ssize_t at = 0; at < bytes;) {
      inotify_event event{};
      std::memcpy(&event, buffer.data() + at, sizeof event);
      if ((event.mask & IN_IGNORED) != 0) folders_.erase(event.wd);
      at += static_cast<ssize_t>(sizeof event) + event.len;
    }
  }
  return any;
}

void FolderEvents::Wake() {
  const std::uint64_t one = 1;
  static_cast<void>(write(wake_, &one, sizeof one));
}

}  // namespace thunderhead::base
