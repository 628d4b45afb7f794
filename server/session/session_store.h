// Keeps sessions' records while the server is down. Used by one thread at a time; every call may
// block.
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

  // Adds the records, or replaces those with the same ids: all of them or, on an error, none.
  virtual absl::Status Save(const std::vector<SessionRecord>& records) = 0;
  // Ids that are not there are no error.
  virtual absl::Status Remove(const std::vector<std::string>& ids) = 0;
  // In order of id. What cannot be read of a record is logged and left out.
  virtual absl::StatusOr<std::vector<SessionRecord>> Load() = 0;
};

}  // namespace thunderhead::session
