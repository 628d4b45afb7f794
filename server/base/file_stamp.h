// Detects whether a file has changed, including when a rename or a link put another file in its
// place.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace thunderhead::base {

struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t size_bytes = 0;
  std::int64_t modified_ns = 0;
  std::int64_t changed_ns = 0;  // contents, owner or permissions
  std::int64_t born_ns = 0;     // 0 if the file system does not record it

  // Returns a number that identifies the file, whatever it contains. The inode alone does not,
  // because a new file may get the inode of a deleted one.
  std::uint64_t Id() const;

  bool operator==(const FileStamp&) const = default;
};

// Returns the time since which a file has been unchanged. `changed_ns` is its change time since
// 1970, according to the file system. That time comes from a wall clock that may have been set
// back, or from another machine, or from a copy of the file. The result is therefore never before
// `earliest`, when the file was absent or different, and never in the future. The result is on the
// steady clock, so a finished file does not wait longer than necessary. `wall` is the wall clock's
// time at `now`.
std::chrono::steady_clock::time_point UnchangedSince(
    std::int64_t changed_ns, std::chrono::steady_clock::time_point earliest,
    std::chrono::steady_clock::time_point now,
    std::chrono::system_clock::time_point wall = std::chrono::system_clock::now());

// Returns nothing if the file cannot be found.
std::optional<FileStamp> StampOf(const std::string& path);

}  // namespace thunderhead::base
