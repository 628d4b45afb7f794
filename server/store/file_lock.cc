#include "store/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"

namespace thunderhead::store {
namespace {

constexpr std::chrono::milliseconds kPatience{2000};
constexpr std::chrono::milliseconds kPause{20};

}  // namespace

absl::StatusOr<FileLock> FileLock::Take(const std::string& path) {
  FileLock lock(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (lock.file_ < 0) {
    return absl::FailedPreconditionError(
        absl::StrCat(path, " cannot be written: ", std::strerror(errno)));
  }
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (flock(lock.file_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK || std::chrono::steady_clock::now() > until) {
      return absl::FailedPreconditionError(
          absl::StrCat(path, " is held by another process (", std::strerror(errno), ")"));
    }
    std::this_thread::sleep_for(kPause);
  }
  return lock;
}

std::optional<FileLock> FileLock::TryFolder(const std::string& folder) {
  FileLock lock(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat about {};
  if (lock.file_ < 0 || fstat(lock.file_, &about) != 0 || about.st_uid != geteuid() ||
      flock(lock.file_, LOCK_EX | LOCK_NB) != 0) {
    return std::nullopt;
  }
  return lock;
}

FileLock::FileLock(FileLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

FileLock::~FileLock() {
  if (file_ >= 0) close(file_);
}

}  // namespace thunderhead::store
