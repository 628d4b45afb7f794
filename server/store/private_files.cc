#include "store/private_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::store {
namespace {

absl::Status CannotWrite(const std::string& path, int why) {
  if (why == ELOOP) {
    return absl::FailedPreconditionError(
        absl::StrCat(path,
                     " is a link, and links are not followed here; put the file in its "
                     "place, or remove the link"));
  }
  return absl::FailedPreconditionError(
      absl::StrCat(path, " cannot be written: ", std::strerror(why)));
}

absl::Status CheckRegular(const std::string& path, mode_t mode) {
  if (S_ISREG(mode)) return absl::OkStatus();
  if (S_ISLNK(mode)) return CannotWrite(path, ELOOP);
  return absl::FailedPreconditionError(absl::StrCat(path, " is not a regular file; move it away"));
}

}  // namespace

absl::Status CheckFolder(const std::string& folder) {
  struct stat about {};
  if (stat(folder.c_str(), &about) != 0) {
    return absl::FailedPreconditionError(
        absl::StrCat(folder, " cannot be used: ", std::strerror(errno)));
  }
  if (about.st_uid != geteuid() && about.st_uid != 0) {
    return absl::FailedPreconditionError(absl::StrCat(
        "the folder ", folder, " belongs to user ", about.st_uid,
        ", who could replace its files; it must belong to root or to the server's user: chown ",
        geteuid(), " ", folder));
  }
  const bool group_is_ours = about.st_uid == 0 && geteuid() != 0 && group_member(about.st_gid) != 0;
  const mode_t refused = group_is_ours ? S_IWOTH : S_IWGRP | S_IWOTH;
  if ((about.st_mode & refused) != 0) {
    return absl::FailedPreconditionError(absl::StrCat("other users may write the folder ", folder,
                                                      ", and could replace its files; run chmod ",
                                                      group_is_ours ? "o-w " : "go-w ", folder));
  }
  return absl::OkStatus();
}

absl::Status CheckFile(const std::string& path) {
  struct stat about {};
  if (lstat(path.c_str(), &about) != 0) {
    return errno == ENOENT ? absl::OkStatus() : CannotWrite(path, errno);
  }
  return CheckRegular(path, about.st_mode);
}

absl::StatusOr<base::FileDescriptor> OpenFile(const std::string& path) {
  // Without O_NONBLOCK, opening a FIFO could wait forever.
  base::FileDescriptor file(
      open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0600));
  struct stat about {};
  if (!file.IsOpen() || fstat(file.Get(), &about) != 0) return CannotWrite(path, errno);
  THUNDERHEAD_RETURN_IF_ERROR(CheckRegular(path, about.st_mode));
  return file;
}

absl::StatusOr<std::optional<FileIdentity>> IdentityAt(const std::string& path) {
  struct stat about {};
  if (lstat(path.c_str(), &about) == 0) return FileIdentity{about.st_dev, about.st_ino};
  if (errno == ENOENT) return std::nullopt;
  return absl::UnavailableError(absl::StrCat(path, " cannot be found: ", std::strerror(errno)));
}

FileIdentity IdentityOf(int file) {
  struct stat about {};
  THUNDERHEAD_CHECK(fstat(file, &about) == 0, "fstat of an open file");
  return {about.st_dev, about.st_ino};
}

}  // namespace thunderhead::store
