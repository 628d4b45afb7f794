#include "storm_files/vdb_start.h"

#include "absl/strings/str_cat.h"

namespace thunderhead::storm_files {

// FAILED_PRECONDITION makes the search of a folder log a warning. INVALID_ARGUMENT would mean a
// file of another kind, and DATA_LOSS a damaged file, which may still be being written.
absl::Status RefuseVdb(const std::string& path) {
  return absl::FailedPreconditionError(absl::StrCat(
      path,
      ": is an OpenVDB file, which names neither its units nor which axis is up; convert it by "
      "`thunderhead import-vdb ",
      path, " --grid ... -o cloud.nc`, and give the converted file"));
}

}  // namespace thunderhead::storm_files
