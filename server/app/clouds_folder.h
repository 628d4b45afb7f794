// The folder for generated clouds: one that the user names, or a temporary one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "store/file_lock.h"

namespace thunderhead::app {

class CloudsFolder {
 public:
  // Opens the folder, and creates it if it does not exist. If `path` is empty, creates a temporary
  // folder, after deleting the temporary folders of servers that were killed. If the folder cannot
  // be created, returns INVALID_ARGUMENT for a named folder and FAILED_PRECONDITION for a temporary
  // one.
  static absl::StatusOr<CloudsFolder> Open(const std::string& path);
  CloudsFolder(CloudsFolder&& other) noexcept;
  CloudsFolder& operator=(CloudsFolder&&) = delete;
  // Deletes the folder with its contents if it is a temporary one.
  ~CloudsFolder();

  const std::string& Path() const { return path_; }
  // Returns the files of clouds from earlier runs.
  std::vector<std::string> Files() const;

 private:
  CloudsFolder(std::string path, std::optional<store::FileLock> held);

  std::string path_;
  std::optional<store::FileLock> held_;  // lock of a temporary folder
};

}  // namespace thunderhead::app
