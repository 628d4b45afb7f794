// The folder that a server keeps generated clouds in: the user's, or one that goes with the server.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::app {

class CloudsFolder {
 public:
  // Makes the folder if it is not there; an empty `path` makes a temporary one.
  static absl::StatusOr<CloudsFolder> Open(const std::string& path);
  CloudsFolder(CloudsFolder&& other) noexcept;
  CloudsFolder& operator=(CloudsFolder&&) = delete;
  // A temporary folder goes, with what is in it.
  ~CloudsFolder();

  const std::string& Path() const { return path_; }
  // Clouds from earlier runs.
  std::vector<std::string> Files() const;

 private:
  CloudsFolder(std::string path, bool temporary);

  std::string path_;
  bool temporary_;
};

}  // namespace thunderhead::app
