#include "base/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/named_file.h"
#include "base/status.h"

namespace thunderhead::base {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int Number() const { return number_; }
  // Hands the descriptor to the caller, who must close it.
  int Release() { return std::exchange(number_, -1); }
  // Returns zero or an error. Network file systems report delayed write errors only when the file
  // is closed.
  int Close() { return close(Release()); }

 private:
  int number_;
};

// Returns the error of the last system call while `path` was being written.
absl::Status NotWritten(const std::string& path) {
  const int code = errno;
  return WriteProblem(
      absl::StrCat(path, " cannot be written (", std::strerror(code),
                   "); check that its folder exists, may be written to and has room"),
      code);
}

bool WriteAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// Removes the partial file after an error, and returns the error.
absl::Status Drop(const std::string& path) {
  absl::Status status = NotWritten(path);
  unlink(PartialPath(path).c_str());
  return status;
}

// Checks that nothing, a regular file, or a link to one or to nothing is at `path`. The rename
// would replace a device or a FIFO. A program that runs as root could replace /dev/null.
absl::Status CheckReplaceable(const std::string& path) {
  if (!IsOtherThanRegularFile(path)) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(path, " is not a regular file and is not replaced by one; choose another name"));
}

bool IsFileWithOneName(const struct stat& found) {
  return S_ISREG(found.st_mode) && found.st_nlink == 1;
}

// Returns whether something other than a regular file with one hard link is at `path`, for example
// a symbolic link or a FIFO. Another user of the folder may have planted it. A folder does not
// count.
bool IsPlanted(const std::string& path) {
  struct stat found {};
  return lstat(path.c_str(), &found) == 0 && !S_ISDIR(found.st_mode) && !IsFileWithOneName(found);
}

// Opens an empty file at PartialPath(path), and returns its descriptor, or -1 with errno set. A
// planted link would lead to another file, and a planted FIFO would wait for a reader or pass the
// bytes to it. Both are therefore removed.
int OpenPartial(const std::string& path) {
  const std::string partial = PartialPath(path);
  // Without O_NONBLOCK, opening a FIFO could wait forever.
  constexpr int kWrite = O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
  Descriptor file(open(partial.c_str(), kWrite, 0666));
  const int why = errno;
  struct stat found {};
  if (file.Number() >= 0 && fstat(file.Number(), &found) == 0 && IsFileWithOneName(found)) {
    return ftruncate(file.Number(), 0) == 0 ? file.Release() : -1;
  }
  if (file.Number() < 0 && !IsPlanted(partial)) {
    errno = why;
    return -1;
  }
  unlink(partial.c_str());
  return open(partial.c_str(), kWrite | O_EXCL, 0666);
}

}  // namespace

absl::StatusOr<std::string> ReadWholeFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::NotFoundError(absl::StrCat(path, ": cannot be read; check the path"));
  return std::string(std::istreambuf_iterator<char>(file), {});
}

absl::Status WriteProblem(std::string_view message, int code) {
  const absl::string_view what(message.data(), message.size());
  switch (code) {
    case ENOENT:
    case ENOTDIR:
    case EISDIR:
    case EEXIST:
    case ELOOP:
    case EACCES:
    case EPERM:
    case EROFS:
    case ENAMETOOLONG:
    case EINVAL:
    case ENOLCK:  // a network file system without locks
    case ENOSYS:
    case EOPNOTSUPP:
      return absl::FailedPreconditionError(what);
    default:
      return absl::UnavailableError(what);
  }
}

absl::Status MakeFolders(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) return absl::OkStatus();
  return WriteProblem(
      absl::StrCat(folder, ": the folder cannot be created (", error.message(), ")"),
      error.value());
}

std::string PartialPath(std::string_view path) {
  return absl::StrCat(absl::string_view(path.data(), path.size()), ".partial");
}

absl::StatusOr<std::string> StartPartial(const std::string& path) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckReplaceable(path));
  const Descriptor file(OpenPartial(path));
  if (file.Number() < 0) return NotWritten(path);
  return PartialPath(path);
}

absl::Status WriteWholeFile(const std::string& path, std::string_view bytes) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckReplaceable(path));
  Descriptor file(OpenPartial(path));
  if (file.Number() < 0) return NotWritten(path);
  if (!WriteAll(file.Number(), bytes) || file.Close() != 0) return Drop(path);
  return PublishFile(path);
}

absl::Status PublishFile(const std::string& path) {
  const std::string partial = PartialPath(path);
  if (absl::Status replaceable = CheckReplaceable(path); !replaceable.ok()) {
    unlink(partial.c_str());
    return replaceable;
  }
  {
    // The file is opened again for fsync, which flushes what any descriptor of the file has
    // written. fsync fails if the file was replaced by a FIFO.
    Descriptor file(open(partial.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (file.Number() < 0 || fsync(file.Number()) != 0) return Drop(path);
  }
  if (std::rename(partial.c_str(), path.c_str()) != 0) return Drop(path);
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const Descriptor entries(
      open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems cannot sync folders. Their error is ignored, because the file already has its
  // new name.
  if (entries.Number() >= 0 && fsync(entries.Number()) != 0 && errno == EIO) {
    return NotWritten(path);
  }
  return absl::OkStatus();
}

}  // namespace thunderhead::base
