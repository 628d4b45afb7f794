#include "base/regular_file.h"

#include <sys/stat.h>

#include "absl/strings/str_cat.h"

namespace thunderhead::base {

absl::Status CheckRegularFile(const std::string& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0 || S_ISREG(found.st_mode)) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(path, " is not a file"));
}

}  // namespace thunderhead::base
