#include "interchange/vdb_file.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "base/program_folder.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "interchange/vdb_writer.h"

namespace thunderhead::interchange {
namespace {

using Writer = decltype(&ThunderheadWriteVdb);

// Loads the library, which is then kept until the process ends.
absl::StatusOr<Writer> LoadWriter() {
  const std::filesystem::path path =
      base::ProgramFolder() / ".." / "lib" / "thunderhead" / "vdb-writer.so";
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const function = library == nullptr ? nullptr : dlsym(library, "ThunderheadWriteVdb");
  if (function != nullptr) return reinterpret_cast<Writer>(function);
  return absl::FailedPreconditionError(absl::StrCat(
      path.lexically_normal().string(), ", which writes OpenVDB files, cannot be loaded (",
      dlerror(), "); install all of Thunderhead"));
}

absl::Status Cancelled() { return absl::CancelledError("interrupted: no file was written"); }

absl::Status NotWritten(const std::string& path, const std::string& why) {
  return absl::UnavailableError(absl::StrCat(path, " cannot be written (", why,
                                             "); check that its folder exists and has room"));
}

}  // namespace

absl::Status WriteVdb(const VdbFile& file, const std::string& path,
                      const std::function<void(double share)>& progress,
                      const std::stop_token& stop) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const Writer write, LoadWriter());
  // The folder is checked before the work, because the work may take a minute.
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string partial, base::StartPartial(path));
  std::string why;
  const VdbWritten written = write(file, partial, progress, stop, why);
  if (written == VdbWritten::kWhole) return base::PublishFile(path);
  std::error_code error;
  std::filesystem::remove(partial, error);
  return written == VdbWritten::kStopped ? Cancelled() : NotWritten(path, why);
}

}  // namespace thunderhead::interchange
