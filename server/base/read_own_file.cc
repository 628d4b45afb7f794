#include "base/read_own_file.h"

#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "base/bounded_file.h"
#include "base/file_descriptor.h"
#include "base/own_file.h"
#include "base/status.h"

namespace thunderhead::base {
namespace {

// Returns the path with its folder's links resolved, or the path itself if there is no such folder.
std::string InRealFolder(const std::string& path) {
  const std::filesystem::path whole(path);
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::canonical(
      whole.has_parent_path() ? whole.parent_path() : std::filesystem::path("."), error);
  return error ? path : (folder / whole.filename()).string();
}

}  // namespace

absl::StatusOr<std::string> ReadOwnFile(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const FileDescriptor file, OpenOwnFile(InRealFolder(path)));
  std::string bytes;
  if (const int code = ReadUpTo(file, bytes.max_size(), bytes); code != 0) {
    return absl::UnavailableError(absl::StrCat("cannot read ", path, ": ", std::strerror(code)));
  }
  return bytes;
}

}  // namespace thunderhead::base
