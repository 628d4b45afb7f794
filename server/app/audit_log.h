// Where the audit's lines go.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "access/audit.h"

namespace thunderhead::app {

// To the file at `path`, to which they are appended and which only its owner may read; to standard
// error if it is empty, among the log's lines and so in its format, "text" or "json". A thread
// writes them, which may fall behind where the disk hangs.
absl::StatusOr<std::shared_ptr<access::Audit>> OpenAudit(const std::string& path,
                                                         const std::string& log_format);

}  // namespace thunderhead::app
