#include "base/read_own_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"
#include "base/own_file.h"
#include "base/status.h"

namespace thunderhead::base {
namespace {

constexpr std::size_t kPieceBytes = 1 << 16;

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
  std::vector<char> piece(kPieceBytes);
  while (true) {
    const ssize_t count = read(file.Get(), piece.data(), piece.size());
    if (count == 0) return bytes;
    if (count > 0) bytes.append(piece.data(), static_cast<std::size_t>(count));
    if (count < 0 && errno != EINTR) {
      return absl::UnavailableError(absl::StrCat("cannot read ", path, ": ", std::strerror(errno)));
    }
  }
}

}  // namespace thunderhead::base
