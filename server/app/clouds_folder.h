// The folder for generated clouds: the user's, or a temporary one.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::app {

class CloudsFolder {
 public:
  // Creates the folder if it does not exist; an empty `path` creates a temporary one, after
  // deleting those of servers that were killed before they could.
  static absl::StatusOr<CloudsFolder> Open(const std::string& path);
  CloudsFolder(CloudsFolder&& other) noexcept;
  CloudsFolder& operator=(CloudsFolder&&) = delete;
  // Deletes a temporary folder with its contents.
  ~CloudsFolder();

  const std::string& Path() const { return path_; }
  // Clouds from earlier runs.
  std::vector<std::string> Files() const;

 private:
  CloudsFolder(std::string path, int held);

  std::string path_;
  int held_;  // the descriptor of a temporary folder, with its lock; -1: not temporary
};

}  // namespace thunderhead::app
