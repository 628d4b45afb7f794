// The interface of a store of session records that survives restarts of the server. Used by one
// thread at a time. Each call may block.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "session/session_record.h"

namespace thunderhead::session {

class SessionStore {
 public:
  virtual ~SessionStore() = default;

  // Adds the records or replaces those with the same ids. On an error, no record is changed.
  virtual absl::Status Save(const std::vector<SessionRecord>& records) = 0;
  // Removes the records with those ids; missing ids are not an error.
  virtual absl::Status Remove(const std::vector<std::string>& ids) = 0;
  // Returns an error if Save would fail although nothing has changed, for example because the
  // store's file was removed and cannot be written anew.
  virtual absl::Status Check() = 0;
  // Returns the records ordered by id. Unreadable parts of a record are logged and left out.
  virtual absl::StatusOr<std::vector<SessionRecord>> Load() = 0;
};

}  // namespace thunderhead::session
