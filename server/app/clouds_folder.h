// The folder for generated clouds: the user's, or a temporary one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "store/file_lock.h"

namespace thunderhead::app {

class CloudsFolder {
 public:
  // Creates the folder if it does not exist. An empty `path` creates a temporary one, after
  // deleting the temporary folders of servers that were killed.
  static absl::StatusOr<CloudsFolder> Open(const std::string& path);
  CloudsFolder(CloudsFolder&& other) noexcept;
  CloudsFolder& operator=(CloudsFolder&&) = delete;
  // Deletes a temporary folder with its contents.
  ~CloudsFolder();

  const std::string& Path() const { return path_; }
  // Returns the files of clouds from earlier runs.
  std::vector<std::string> Files() const;

 private:
  CloudsFolder(std::string path, std::optional<store::FileLock> held);

  std::string path_;
  std::optional<store::FileLock> held_;  // only for a temporary folder
};

}  // namespace thunderhead::app
