// How the thread of render jobs looks at storms' files. A plain value.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "base/file_stamp.h"

namespace thunderhead::service {

struct JobFiles {
  std::function<std::optional<base::FileStamp>(const std::string& path)> stamp = base::StampOf;
  // How long that may take, and reading a piece of a result; then the file's storage hangs. Its
  // pictures are tried again later.
  std::chrono::milliseconds patience = std::chrono::seconds(5);
};

}  // namespace thunderhead::service
