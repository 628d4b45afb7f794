// Tells whether a file has changed, also where another took its place by a rename or a link.
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
  std::int64_t born_ns = 0;     // 0 where the file system does not know

  // Tells it from other files, whatever is in it: a new file may get the inode of one that is gone.
  std::uint64_t Id() const;

  bool operator==(const FileStamp&) const = default;
};

// Since when a file has been unchanged, of which the system says that it changed at `changed_ns`
// (since 1970). That is by the wall clock, which may be set back, be another machine's or be a
// copy's: it counts only from `earliest` on, before which the file was not there or was another,
// and never into the future. Counted on by the steady clock, a complete file is waited for no
// longer than it rests. `wall` is the wall clock's time at `now`.
std::chrono::steady_clock::time_point UnchangedSince(
    std::int64_t changed_ns, std::chrono::steady_clock::time_point earliest,
    std::chrono::steady_clock::time_point now,
    std::chrono::system_clock::time_point wall = std::chrono::system_clock::now());

// None if the file cannot be found.
std::optional<FileStamp> StampOf(const std::string& path);

}  // namespace thunderhead::base
