#include "app/output_file.h"

#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"

namespace thunderhead::app {

absl::Status WriteFile(const std::string& path, const std::string& bytes) {
  const std::string partial = path + ".partial";
  std::ofstream file(partial, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(partial, path, error);
  if (file && !error) return absl::OkStatus();
  std::filesystem::remove(partial, error);
  return absl::UnavailableError(
      absl::StrCat(path, " cannot be written; check that its folder exists and has room"));
}

}  // namespace thunderhead::app
