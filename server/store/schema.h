// The tables of the store's file, and the steps that bring those of an older version up to date.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "store/sqlite.h"

namespace thunderhead::store {

// Creates or updates the tables. FAILED_PRECONDITION, naming the file `path`, if it is of a newer
// version or another program's.
absl::Status UpdateSchema(Database& database, const std::string& path);

}  // namespace thunderhead::store
