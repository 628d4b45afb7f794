#include "base/file_stamp.h"

#include <sys/stat.h>

#include <algorithm>

namespace thunderhead::base {
namespace {

std::int64_t Nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

std::chrono::steady_clock::time_point UnchangedSince(std::int64_t changed_ns,
                                                     std::chrono::steady_clock::time_point earliest,
                                                     std::chrono::steady_clock::time_point now) {
  using std::chrono::nanoseconds;
  constexpr nanoseconds kLongest = std::chrono::hours(24 * 365);
  const nanoseconds wall = std::chrono::system_clock::now().time_since_epoch();
  const nanoseconds age = std::clamp(wall - nanoseconds(changed_ns), nanoseconds(0), kLongest);
  return std::max(earliest, now - age);
}

std::optional<FileStamp> StampOf(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return FileStamp{status.st_dev, status.st_ino, status.st_size, Nanoseconds(status.st_mtim),
                   Nanoseconds(status.st_ctim)};
}

}  // namespace thunderhead::base
