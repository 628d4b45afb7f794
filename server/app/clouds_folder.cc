#include "app/clouds_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"

namespace thunderhead::app {

namespace fs = std::filesystem;

CloudsFolder::CloudsFolder(std::string path, bool temporary)
    : path_(std::move(path)), temporary_(temporary) {}

CloudsFolder::CloudsFolder(CloudsFolder&& other) noexcept
    : path_(std::move(other.path_)), temporary_(std::exchange(other.temporary_, false)) {}

CloudsFolder::~CloudsFolder() {
  std::error_code error;
  if (temporary_) fs::remove_all(path_, error);
}

absl::StatusOr<CloudsFolder> CloudsFolder::Open(const std::string& path) {
  std::error_code error;
  if (path.empty()) {
    std::string name = (fs::temp_directory_path(error) / "thunderhead-clouds-XXXXXX").string();
    if (error || mkdtemp(name.data()) == nullptr) {
      return absl::FailedPreconditionError(
          absl::StrCat("cannot create a temporary folder for clouds (", std::strerror(errno),
                       "); name a folder with --clouds"));
    }
    return CloudsFolder(std::move(name), true);
  }
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--clouds is '", path,
                     "', which is not a folder and cannot be created: ", error.message()));
  }
  return CloudsFolder(path, false);
}

std::vector<std::string> CloudsFolder::Files() const {
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path_, error)) {
    if (entry.path().extension() == ".nc") files.push_back(entry.path().string());
  }
  return files;
}

}  // namespace thunderhead::app
