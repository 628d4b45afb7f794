#include "base/file_stamp.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>

namespace thunderhead::base {
namespace {

std::int64_t Nanoseconds(const statx_timestamp& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

std::chrono::steady_clock::time_point UnchangedSince(std::int64_t changed_ns,
                                                     std::chrono::steady_clock::time_point earliest,
                                                     std::chrono::steady_clock::time_point now,
                                                     std::chrono::system_clock::time_point wall) {
  using std::chrono::nanoseconds;
  constexpr nanoseconds kLongest = std::chrono::hours(24 * 365);
  const nanoseconds age = std::clamp(nanoseconds(wall.time_since_epoch()) - nanoseconds(changed_ns),
                                     nanoseconds(0), kLongest);
  return std::max(earliest, now - age);
}

std::optional<FileStamp> StampOf(const std::string& path) {
  struct statx status {};
  if (::statx(AT_FDCWD, path.c_str(), 0, STATX_BASIC_STATS | STATX_BTIME, &status) != 0) {
    return std::nullopt;
  }
  const bool tells_birth = (status.stx_mask & STATX_BTIME) != 0;
  return FileStamp{.device = makedev(status.stx_dev_major, status.stx_dev_minor),
                   .inode = status.stx_ino,
                   .size_bytes = static_cast<std::int64_t>(status.stx_size),
                   .modified_ns = Nanoseconds(status.stx_mtime),
                   .changed_ns = Nanoseconds(status.stx_ctime),
                   .born_ns = tells_birth ? Nanoseconds(status.stx_btime) : 0};
}

std::uint64_t FileStamp::Id() const {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15U;  // spreads the nanoseconds over all bits
  return inode ^ (device << 48U) ^ (kOdd * static_cast<std::uint64_t>(born_ns));
}

}  // namespace thunderhead::base
