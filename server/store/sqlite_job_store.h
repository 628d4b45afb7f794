// A store for render jobs in a server's state file.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "jobs/job_store.h"
#include "store/state_file.h"

namespace thunderhead::store {

class SqliteJobStore : public jobs::JobStore {
 public:
  // Returns the store of the jobs in `file`. Errors are those of Connection::Open.
  static absl::StatusOr<std::unique_ptr<SqliteJobStore>> In(std::shared_ptr<StateFile> file);
};

}  // namespace thunderhead::store
