// Sessions in a server's state file. What was saved outlives the end of the process; a loss of
// power may cost the last seconds, never the file.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "session/session_store.h"
#include "store/state_file.h"

namespace thunderhead::store {

class SqliteSessionStore : public session::SessionStore {
 public:
  static absl::StatusOr<std::unique_ptr<SqliteSessionStore>> In(std::shared_ptr<StateFile> file);
  // The only part of its file; errors as StateFile::Open.
  static absl::StatusOr<std::unique_ptr<SqliteSessionStore>> Open(const std::string& path);
};

}  // namespace thunderhead::store
