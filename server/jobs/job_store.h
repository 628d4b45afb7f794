// Stores the records of jobs, so that they survive a restart of the server. A store is used by one
// thread at a time, and each call may block. What a finished call has stored survives even a loss
// of power.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "jobs/job_record.h"

namespace thunderhead::jobs {

// The changes of a job since it was last saved.
struct JobChange {
  struct Picture {
    std::size_t place = 0;
    ImageRecord record;  // `order` never changes and is not saved again
  };

  std::string id;
  std::optional<Time> ended_at;
  bool cancelled = false;
  std::vector<Picture> pictures;
};

class JobStore {
 public:
  virtual ~JobStore() = default;

  // Stores a job with all its pictures. If it returns an error, nothing is stored.
  virtual absl::Status Add(const JobRecord& job) = 0;
  // Saves all changes. If it returns an error, no change is saved. Changes of jobs that are not in
  // the store are ignored.
  virtual absl::Status Save(const std::vector<JobChange>& changes) = 0;
  // Removes the jobs with these ids. Ids that are not in the store are ignored.
  virtual absl::Status Remove(const std::vector<std::string>& ids) = 0;
  // Returns the jobs in the order of their creation. Unreadable parts are logged and left out.
  virtual absl::StatusOr<std::vector<JobRecord>> Load() = 0;
};

}  // namespace thunderhead::jobs
