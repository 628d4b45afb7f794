// How render jobs check storm files and open results. A plain value that tests can replace.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "base/file_descriptor.h"
#include "base/file_stamp.h"
#include "base/own_file.h"

namespace thunderhead::service {

// Opens the file of a result, as base::OpenOwnFile does.
using OpenResult = std::function<absl::StatusOr<base::FileDescriptor>(const std::string& path)>;

struct JobFiles {
  std::function<std::optional<base::FileStamp>(const std::string& path)> stamp = base::StampOf;
  OpenResult open_result = &base::OpenOwnFile;
  // The timeout of `stamp`, and of reading a piece of a result. If it expires, the file's storage
  // counts as blocked, and the pictures of the file are retried later.
  std::chrono::milliseconds patience = std::chrono::seconds(5);
};

}  // namespace thunderhead::service
