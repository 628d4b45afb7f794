// The identity, size and times of a file (its stamp). Comparing two stamps of a path shows whether
// the file has changed, or was replaced by another file through a rename or a link.
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
  std::int64_t changed_ns = 0;  // when contents, owner or permissions last changed
  std::int64_t born_ns = 0;     // creation time; 0 if the file system does not record it

  // Returns a number that identifies the file and stays the same when its contents change. The
  // inode alone does not, because a new file may get the inode of a deleted one.
  std::uint64_t Id() const;

  bool operator==(const FileStamp&) const = default;
};

// Returns the time on the steady clock since which a file has been unchanged. `changed_ns` is the
// file's change time in ns since 1970, as the file system reports it. This time can be wrong: a
// wall clock may have been set back, and another machine's clock may differ. The result is
// therefore limited to between `earliest`, when the file was absent or different, and `now`. `wall`
// is the wall clock's time at `now`.
std::chrono::steady_clock::time_point UnchangedSince(
    std::int64_t changed_ns, std::chrono::steady_clock::time_point earliest,
    std::chrono::steady_clock::time_point now,
    std::chrono::system_clock::time_point wall = std::chrono::system_clock::now());

// Returns the stamp of the file at `path`, following links, or nothing if there is no file.
std::optional<FileStamp> StampOf(const std::string& path);

}  // namespace thunderhead::base
