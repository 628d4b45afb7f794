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
#include "base/status.h"

namespace thunderhead::store {
namespace {

constexpr std::chrono::milliseconds kPause{20};

}  // namespace

absl::StatusOr<FileLock> FileLock::Take(const std::string& path,
                                        std::chrono::milliseconds patience) {
  THUNDERHEAD_ASSIGN_OR_RETURN(base::FileDescriptor file, OpenFile(path));
  const auto until = std::chrono::steady_clock::now() + patience;
  while (flock(file.Get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK || std::chrono::steady_clock::now() >= until) {
      return absl::FailedPreconditionError(
          absl::StrCat(path, " is held by another process (", std::strerror(errno), ")"));
    }
    std::this_thread::sleep_for(kPause);
  }
  return FileLock(std::move(file));
}

std::optional<FileLock> FileLock::TryFolder(const std::string& folder) {
  base::FileDescriptor file(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat about {};
  if (!file.IsOpen() || fstat(file.Get(), &about) != 0 || about.st_uid != geteuid() ||
      flock(file.Get(), LOCK_EX | LOCK_NB) != 0) {
    return std::nullopt;
  }
  return FileLock(std::move(file));
}

}  // namespace thunderhead::store
