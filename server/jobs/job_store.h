// Keeps jobs' records while the server is down. Used by one thread at a time; every call may block,
// and what it has done when it returns outlives also a loss of power.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "jobs/job_record.h"

namespace thunderhead::jobs {

// Changes of a job since it was saved.
struct JobChange {
  struct Picture {
    std::size_t place = 0;
    PictureRecord record;  // its order does not change
  };

  std::string id;
  std::optional<Time> ended_at;
  bool cancelled = false;
  std::vector<Picture> pictures;
};

class JobStore {
 public:
  virtual ~JobStore() = default;

  // Stores a job with all of its pictures or, on an error, nothing of it.
  virtual absl::Status Add(const JobRecord& job) = 0;
  // All of the changes or, on an error, none. Jobs that are not there are no error.
  virtual absl::Status Save(const std::vector<JobChange>& changes) = 0;
  // Ids that are not there are no error.
  virtual absl::Status Remove(const std::vector<std::string>& ids) = 0;
  // In the order in which they were created. What cannot be read is logged and left out.
  virtual absl::StatusOr<std::vector<JobRecord>> Load() = 0;
};

}  // namespace thunderhead::jobs
