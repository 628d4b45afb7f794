// A store for sessions in a server's state file. Saved data survives the end of the process and a
// loss of power.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "session/session_store.h"
#include "store/state_file.h"

namespace thunderhead::store {

class SqliteSessionStore : public session::SessionStore {
 public:
  // Returns the store of the sessions in `file`. Errors are those of Connection::Open.
  static absl::StatusOr<std::unique_ptr<SqliteSessionStore>> In(std::shared_ptr<StateFile> file);
  // Opens the state file at `path`, which this store alone uses. Errors are those of
  // StateFile::Open.
  static absl::StatusOr<std::unique_ptr<SqliteSessionStore>> Open(const std::string& path);
};

}  // namespace thunderhead::store
