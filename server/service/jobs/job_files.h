// How the thread of render jobs checks storm files. A plain value that tests can replace.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "base/file_stamp.h"

namespace thunderhead::service {

struct JobFiles {
  std::function<std::optional<base::FileStamp>(const std::string& path)> stamp = base::StampOf;
  // The timeout of this check, and of reading a piece of a result. If it expires, the file's
  // storage counts as blocked, and the pictures of the file are retried later.
  std::chrono::milliseconds patience = std::chrono::seconds(5);
};

}  // namespace thunderhead::service
