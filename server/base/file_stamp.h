// Tells whether a file has changed, also where another took its place by a rename or a link.
#pragma once

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

  bool operator==(const FileStamp&) const = default;
};

// None if the file cannot be found.
std::optional<FileStamp> StampOf(const std::string& path);

}  // namespace thunderhead::base
