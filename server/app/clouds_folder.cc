#include "app/clouds_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

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
// A server that starts has its folder for a moment before it locks it.
constexpr std::chrono::minutes kStarting{1};

// A descriptor with the lock of a folder of this user, which the system releases when the process
// ends, however that happens; -1 if a process holds it.
int Held(const std::string& folder) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return -1;
  struct stat about {};
  if (fstat(file, &about) == 0 && about.st_uid == geteuid() &&
      flock(file, LOCK_EX | LOCK_NB) == 0) {
    return file;
  }
  close(file);
  return -1;
}

// Deletes what killed servers left.
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
    const int file = Held(folder.string());
    if (file < 0) continue;
    fs::remove_all(folder, ignored);
    close(file);
  }
}

}  // namespace

CloudsFolder::CloudsFolder(std::string path, int held) : path_(std::move(path)), held_(held) {}

CloudsFolder::CloudsFolder(CloudsFolder&& other) noexcept
    : path_(std::move(other.path_)), held_(std::exchange(other.held_, -1)) {}

CloudsFolder::~CloudsFolder() {
  if (held_ < 0) return;
  std::error_code error;
  fs::remove_all(path_, error);
  close(held_);
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
    const int held = Held(name);
    if (held < 0) {
      return absl::FailedPreconditionError(
          absl::StrCat("cannot lock the temporary folder for clouds, ", name, " (",
                       std::strerror(errno), "); name a folder with --clouds"));
    }
    return CloudsFolder(std::move(name), held);
  }
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--clouds is '", path,
                     "', which is not a folder and cannot be created: ", error.message()));
  }
  return CloudsFolder(path, -1);
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
