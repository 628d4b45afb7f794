// Opens the destination of the audit log.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "access/audit.h"

namespace thunderhead::app {

// Opens the audit log. Entries are appended to the regular file at `path`, which only its owner may
// read if it is created here. Returns INVALID_ARGUMENT for anything else, such as a FIFO.
// If `path` is empty, they are written to standard error with the log, in its format `log_format`,
// "text" or "json". A separate thread writes them, and may fall behind if the disk blocks.
absl::StatusOr<std::shared_ptr<access::Audit>> OpenAudit(const std::string& path,
                                                         const std::string& log_format);

}  // namespace thunderhead::app
