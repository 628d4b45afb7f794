#include "app/clouds_folder.h"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"

namespace thunderhead::app {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTemporary = "thunderhead-clouds-";
// Folders younger than this are kept even if no server has locked them. A starting server creates
// its folder first and locks the folder shortly afterwards.
constexpr std::chrono::minutes kStarting{1};

// Deletes the folders of servers that were killed.
void DeleteAbandoned(const fs::path& parent) {
  std::error_code error;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& folder = entry->path();
    std::error_code ignored;
    if (!folder.filename().string().starts_with(kTemporary) ||
        fs::file_time_type::clock::now() - entry->last_write_time(ignored) < kStarting) {
      continue;
    }
    const auto lock = store::FileLock::TryFolder(folder.string());
    if (lock.has_value()) fs::remove_all(folder, ignored);
  }
}

}  // namespace

CloudsFolder::CloudsFolder(std::string path, std::optional<store::FileLock> held)
    : path_(std::move(path)), held_(std::move(held)) {}

CloudsFolder::CloudsFolder(CloudsFolder&& other) noexcept
    : path_(std::move(other.path_)), held_(std::move(other.held_)) {
  other.held_.reset();
}

CloudsFolder::~CloudsFolder() {
  std::error_code error;
  if (held_.has_value()) fs::remove_all(path_, error);
}

absl::StatusOr<CloudsFolder> CloudsFolder::Open(const std::string& path) {
  std::error_code error;
  if (path.empty()) {
    const fs::path parent = fs::temp_directory_path(error);
    std::string name = (parent / (std::string(kTemporary) + "XXXXXX")).string();
    if (!error) DeleteAbandoned(parent);
    if (error || mkdtemp(name.data()) == nullptr) {
      return absl::FailedPreconditionError(
          absl::StrCat("cannot create a temporary folder for clouds (", std::strerror(errno),
                       "); name a folder with --clouds"));
    }
    auto held = store::FileLock::TryFolder(name);
    if (!held.has_value()) {
      return absl::FailedPreconditionError(
          absl::StrCat("cannot lock the temporary folder for clouds, ", name, " (",
                       std::strerror(errno), "); name a folder with --clouds"));
    }
    return CloudsFolder(std::move(name), std::move(held));
  }
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--clouds is '", path,
                     "', which is not a folder and cannot be created: ", error.message()));
  }
  return CloudsFolder(path, std::nullopt);
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
