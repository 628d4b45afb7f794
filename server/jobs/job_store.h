// Keeps jobs' records while the server is down. Used by one thread at a time; each call may block.
// A finished call is durable, even after a loss of power.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "jobs/job_record.h"

namespace thunderhead::jobs {

// The changes of a job since it was saved.
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

  // Stores a job with all its pictures. On an error, nothing of it is stored.
  virtual absl::Status Add(const JobRecord& job) = 0;
  // Saves all changes. On an error, none is saved. Missing jobs are not an error.
  virtual absl::Status Save(const std::vector<JobChange>& changes) = 0;
  // Removes the jobs with those ids; missing ids are not an error.
  virtual absl::Status Remove(const std::vector<std::string>& ids) = 0;
  // Returns the jobs in the order of their creation. Unreadable parts are logged and left out.
  virtual absl::StatusOr<std::vector<JobRecord>> Load() = 0;
};

}  // namespace thunderhead::jobs
