#include "pipeline/folder_watch.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "spdlog/spdlog.h"

namespace thunderhead::pipeline {

absl::StatusOr<FolderWatch> FolderWatch::Open(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    return absl::NotFoundError(absl::StrCat(folder, ": there is no such folder; create it"));
  }
  FolderWatch watch(inotify_init1(IN_NONBLOCK | IN_CLOEXEC),
                    eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (watch.wake_ < 0) {
    return absl::ResourceExhaustedError(
        absl::StrCat("too many files are open (", std::strerror(errno), ")"));
  }
  constexpr std::uint32_t kEvents =
      IN_CLOSE_WRITE | IN_CREATE | IN_MOVED_TO | IN_MOVED_FROM | IN_DELETE;
  if (watch.events_ < 0 || inotify_add_watch(watch.events_, folder.c_str(), kEvents) < 0) {
    spdlog::warn("{}: no events of the file system ({}); it is looked at now and then", folder,
                 std::strerror(errno));
  }
  return watch;
}

FolderWatch::FolderWatch(FolderWatch&& other) noexcept
    : events_(std::exchange(other.events_, -1)), wake_(std::exchange(other.wake_, -1)) {}

FolderWatch::~FolderWatch() {
  if (events_ >= 0) close(events_);
  if (wake_ >= 0) close(wake_);
}

void FolderWatch::Wait(absl::Duration longest) {
  std::array<pollfd, 2> files = {{{wake_, POLLIN, 0}, {events_, POLLIN, 0}}};
  if (poll(files.data(), files.size(), static_cast<int>(absl::ToInt64Milliseconds(longest))) <= 0) {
    return;
  }
  std::array<char, 4096> events;
  while (events_ >= 0 && read(events_, events.data(), events.size()) > 0) {
  }
}

void FolderWatch::Wake() const {
  const std::uint64_t one = 1;
  // Fails only when it is awake already.
  [[maybe_unused]] const ssize_t written = write(wake_, &one, sizeof one);
}

}  // namespace thunderhead::pipeline
