#include "base/own_file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::base {
namespace {

absl::Status NotRegular(const std::string& path) {
  return absl::DataLossError(
      absl::StrCat(path, " is a link, or not a regular file in a regular folder; remove it"));
}

// Returns the error of the last system call.
absl::Status NotOpened(const std::string& path) {
  const int code = errno;
  if (code == ELOOP || code == ENOTDIR || code == ENXIO) return NotRegular(path);
  const std::string what = absl::StrCat("cannot read ", path, ": ", std::strerror(code));
  return code == ENOENT ? absl::NotFoundError(what) : absl::UnavailableError(what);
}

int OpenUninterrupted(int folder, const char* name, int flags) {
  int file = openat(folder, name, flags | O_CLOEXEC | O_NOFOLLOW);
  while (file < 0 && errno == EINTR) file = openat(folder, name, flags | O_CLOEXEC | O_NOFOLLOW);
  return file;
}

// Returns the path with its folder's links resolved, or the path itself if there is no such folder.
std::string InRealFolder(const std::string& path) {
  const std::filesystem::path whole(path);
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::canonical(
      whole.has_parent_path() ? whole.parent_path() : std::filesystem::path("."), error);
  return error ? path : (folder / whole.filename()).string();
}

}  // namespace

absl::StatusOr<FileDescriptor> OpenOwnFile(const std::string& path) {
  const std::filesystem::path whole(path);
  const std::string parent = whole.has_parent_path() ? whole.parent_path().string() : ".";
  const FileDescriptor folder(OpenUninterrupted(AT_FDCWD, parent.c_str(), O_PATH | O_DIRECTORY));
  if (!folder.IsOpen()) return NotOpened(path);
  FileDescriptor file(
      OpenUninterrupted(folder.Get(), whole.filename().c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY));
  if (!file.IsOpen()) return NotOpened(path);
  struct stat found {};
  if (fstat(file.Get(), &found) != 0) return NotOpened(path);
  if (!S_ISREG(found.st_mode)) return NotRegular(path);
  return file;
}

absl::StatusOr<std::string> ReadOwnFile(const std::string& path) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const FileDescriptor file, OpenOwnFile(InRealFolder(path)));
  std::string bytes;
  if (const int code = ReadUpTo(file, bytes.max_size(), bytes); code != 0) {
    return absl::UnavailableError(absl::StrCat("cannot read ", path, ": ", std::strerror(code)));
  }
  return bytes;
}

}  // namespace thunderhead::base
