// Opens the destination of the audit log.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "access/audit.h"

namespace thunderhead::app {

// Opens the audit log, whose lines are appended to the regular file at `path`. If the file is
// created here, only its owner may read it. Returns INVALID_ARGUMENT if the file cannot be opened,
// or is not a regular file (such as a FIFO). If `path` is empty, the lines go to standard error, in
// the format `log_format` of the log ("text" or "json"). A separate thread writes the lines, and
// may fall behind if the disk blocks.
absl::StatusOr<std::shared_ptr<access::Audit>> OpenAudit(const std::string& path,
                                                         const std::string& log_format);

}  // namespace thunderhead::app
