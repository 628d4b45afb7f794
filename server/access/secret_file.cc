#include "access/secret_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::access {
namespace {

constexpr std::size_t kMaxBytes = 4u << 20;

absl::Status CannotRead(const std::string& path) {
  return absl::FailedPreconditionError(absl::StrCat("cannot read ", path, ": ", strerror(errno)));
}

absl::Status CheckOwner(const std::string& path, const struct stat& status) {
  if (!S_ISREG(status.st_mode)) {
    return absl::FailedPreconditionError(absl::StrCat(path, " is not a file"));
  }
  if (status.st_uid != geteuid() && status.st_uid != 0) {
    return absl::FailedPreconditionError(absl::StrCat(
        path, " belongs to user ", status.st_uid, ", who could change it; it must belong to ",
        "root or to the server's user: chown ", geteuid(), " ", path));
  }
  if ((status.st_mode & (S_IWGRP | S_IWOTH | S_IRWXO)) != 0) {
    return absl::FailedPreconditionError(
        absl::StrCat(path, " may be read or written by other users; run chmod go-w,o= ", path));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> ReadSecretFile(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return CannotRead(path);
  const absl::Cleanup close = [file] { ::close(file); };
  struct stat status {};
  if (::fstat(file, &status) != 0) return CannotRead(path);
  THUNDERHEAD_RETURN_IF_ERROR(CheckOwner(path, status));
  std::string text;
  char block[4096];
  while (true) {
    const ssize_t count = ::read(file, block, sizeof(block));
    if (count < 0) return CannotRead(path);
    if (count == 0) return text;
    text.append(block, static_cast<std::size_t>(count));
    if (text.size() > kMaxBytes) {
      return absl::FailedPreconditionError(
          absl::StrCat(path, " is larger than ", kMaxBytes >> 20,
                       " MiB; check that the flag names the right file"));
    }
  }
}

void TellOfReload(const std::string& path, const absl::Status& status) {
  if (status.ok()) return spdlog::info("{} has changed and was read again", path);
  spdlog::error("{} has changed and cannot be used; its former content stays valid: {}", path,
                std::string(status.message()));
}

}  // namespace thunderhead::access
