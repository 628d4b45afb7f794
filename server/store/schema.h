// The tables of the server's state file (SQLite), and the migration steps from older versions.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "store/sqlite.h"

namespace thunderhead::store {

// Creates the tables, or updates them from an older version. Returns FAILED_PRECONDITION, naming
// the file `path`, if the file has a newer version or belongs to another program. Returns DATA_LOSS
// if the file does not have the tables of its version, or has views or triggers.
absl::Status UpdateSchema(Database& database, const std::string& path);

}  // namespace thunderhead::store
