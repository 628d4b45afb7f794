// A store for render jobs in a server's state file.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "jobs/job_store.h"
#include "store/state_file.h"

namespace thunderhead::store {

class SqliteJobStore : public jobs::JobStore {
 public:
  static absl::StatusOr<std::unique_ptr<SqliteJobStore>> In(std::shared_ptr<StateFile> file);
};

}  // namespace thunderhead::store
