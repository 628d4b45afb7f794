// Opens the destination of the audit log.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "access/audit.h"

namespace thunderhead::app {

// Opens the audit log, which appends to the file at `path`; only its owner may read the file. If
// `path` is empty, the lines go to standard error among the log's lines and in its format, "text"
// or "json". A separate thread writes them, and may fall behind if the disk hangs.
absl::StatusOr<std::shared_ptr<access::Audit>> OpenAudit(const std::string& path,
                                                         const std::string& log_format);

}  // namespace thunderhead::app
