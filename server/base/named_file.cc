#include "base/named_file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"

namespace thunderhead::base {
namespace {

absl::Status Unreadable(const std::string& path, int code) {
  return absl::InvalidArgumentError(
      absl::StrCat(path, " cannot be read (", std::strerror(code), "); check the path"));
}

std::string SizeText(std::size_t bytes) {
  if (bytes % (1 << 20) == 0) return absl::StrCat(bytes >> 20, " MiB");
  if (bytes % (1 << 10) == 0) return absl::StrCat(bytes >> 10, " KiB");
  return absl::StrCat(bytes, " bytes");
}

absl::StatusOr<std::string> ReadStart(const std::string& path, std::size_t max_bytes,
                                      bool may_be_pipe) {
  // Without O_NONBLOCK, opening a FIFO would wait for a program that writes to it.
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file.IsOpen()) return Unreadable(path, errno);
  struct stat found {};
  if (::fstat(file.Get(), &found) != 0) return Unreadable(path, errno);
  // O_NONBLOCK is cleared for a pipe, because reading a pipe must wait for its writers.
  if (S_ISFIFO(found.st_mode) && ::fcntl(file.Get(), F_SETFL, 0) != 0)
    return Unreadable(path, errno);
  if (!S_ISREG(found.st_mode) && !(may_be_pipe && S_ISFIFO(found.st_mode))) {
    return absl::InvalidArgumentError(absl::StrCat(
        path, may_be_pipe ? " is neither a regular file nor a pipe" : " is not a regular file",
        "; check the path"));
  }
  std::string bytes;
  if (const int code = ReadUpTo(file, max_bytes, bytes); code != 0) return Unreadable(path, code);
  return bytes;
}

absl::StatusOr<std::string> ReadWhole(const std::string& path, std::size_t max_bytes,
                                      bool may_be_pipe) {
  absl::StatusOr<std::string> bytes = ReadStart(path, max_bytes + 1, may_be_pipe);
  if (bytes.ok() && bytes->size() > max_bytes) return TooLarge(path, max_bytes);
  return bytes;
}

}  // namespace

absl::Status TooLarge(const std::string& what, std::size_t max_bytes) {
  return absl::InvalidArgumentError(absl::StrCat(what, " has more than ", SizeText(max_bytes),
                                                 ", the limit; check that it is the right file"));
}

absl::StatusOr<std::string> ReadFileStart(const std::string& path, std::size_t max_bytes) {
  return ReadStart(path, max_bytes, /*may_be_pipe=*/true);
}

absl::StatusOr<std::string> ReadBoundedFile(const std::string& path, std::size_t max_bytes) {
  return ReadWhole(path, max_bytes, /*may_be_pipe=*/true);
}

absl::StatusOr<std::string> ReadRegularFile(const std::string& path, std::size_t max_bytes) {
  return ReadWhole(path, max_bytes, /*may_be_pipe=*/false);
}

bool IsOtherThanRegularFile(const std::string& path) {
  struct stat found {};
  return stat(path.c_str(), &found) == 0 && !S_ISREG(found.st_mode);
}

absl::Status CheckRegularFile(const std::string& path) {
  if (!IsOtherThanRegularFile(path)) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(path, " is not a file"));
}

}  // namespace thunderhead::base
