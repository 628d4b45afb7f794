#include "netcdf/open_errors.h"

#include <fcntl.h>
#include <netcdf.h>
#include <sys/file.h>

#include <cerrno>

#include "absl/strings/str_cat.h"
#include "base/file_descriptor.h"

namespace thunderhead::netcdf {

bool IsHeldByWriter(int file) {
  if (flock(file, LOCK_SH | LOCK_NB) != 0) return errno == EWOULDBLOCK;
  flock(file, LOCK_UN);
  return false;
}

bool IsHeldByWriter(const std::string& path) {
  const base::FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  return file.IsOpen() && IsHeldByWriter(file.Get());
}

absl::Status HeldByWriter(const std::string& path) {
  return absl::UnavailableError(absl::StrCat(
      path, ": another program is writing it; try again when the model has closed it"));
}

absl::Status OpenError(const std::string& path, int code) {
  const std::string what = absl::StrCat(path, ": ");
  switch (code) {
    case ENOENT:
      return absl::NotFoundError(absl::StrCat(what, "there is no such file; check the path"));
    case EACCES:
      return absl::PermissionDeniedError(
          absl::StrCat(what, "may not be read; give this user permission to read it"));
    case EAGAIN:
      return HeldByWriter(path);
    case NC_ENOTNC:
      return absl::InvalidArgumentError(
          absl::StrCat(what,
                       "is not a netCDF file, and does not begin like a file of any other "
                       "format; give a model's output file"));
    default:
      return absl::DataLossError(
          absl::StrCat(what, "cannot be opened as netCDF (", nc_strerror(code),
                       "); it is cut short, damaged or still being written: wait for the model "
                       "to finish, or copy the file again"));
  }
}

absl::Status EmptyFile(const std::string& path) {
  return absl::DataLossError(
      absl::StrCat(path, ": is empty (0 bytes); wait for the model to write it, or copy it again"));
}

}  // namespace thunderhead::netcdf
