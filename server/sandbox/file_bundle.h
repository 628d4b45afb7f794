// Several files as the bytes of one: a table of their paths and sizes, and their contents one after
// the other. The server copies files into memory in this form, without parsing them, and passes the
// memory to a reader. The reader then needs only one descriptor.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"
#include "base/file_stamp.h"

namespace thunderhead::sandbox {

struct FileBundle {
  base::FileDescriptor file;            // an anonymous file in memory
  std::vector<base::FileStamp> stamps;  // a stamp of each file, in the order of the paths
};

// Opens a file for reading and checks it.
using OpenChecked = std::function<absl::StatusOr<base::FileDescriptor>(const std::string& path)>;

// Copies the files at `paths` into memory. Returns RESOURCE_EXHAUSTED if they are larger than
// `most_bytes` together, NOT_FOUND if one does not exist, and UNAVAILABLE if one cannot be copied
// or becomes shorter meanwhile. Errors name the file.
absl::StatusOr<FileBundle> Bundle(const std::vector<std::string>& paths, const OpenChecked& open,
                                  std::size_t most_bytes);

struct BundledFile {
  std::string path;
  std::span<const std::byte> bytes;
};

// Returns the files in the bytes of a bundle. Returns INTERNAL if the table or a file is
// incomplete.
absl::StatusOr<std::vector<BundledFile>> FilesOfBundle(std::span<const std::byte> bytes);

}  // namespace thunderhead::sandbox
