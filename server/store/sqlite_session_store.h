// Sessions in one SQLite file, which this process alone uses while the store is open. What was
// saved outlives the end of the process; a loss of power may cost the last seconds, never the file.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "session/session_store.h"

namespace thunderhead::store {

class SqliteSessionStore : public session::SessionStore {
 public:
  // Creates the file, for this user only, or brings the tables of an older version up to date.
  // FAILED_PRECONDITION, naming the file and the remedy, if another process has it open, or it is
  // of a newer version or another program's; DATA_LOSS if it is damaged.
  static absl::StatusOr<std::unique_ptr<SqliteSessionStore>> Open(const std::string& path);
};

}  // namespace thunderhead::store
