// The flags of render jobs.
#pragma once

#include <memory>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "app/state_folder.h"
#include "jobs/jobs.h"

namespace thunderhead::app {

struct JobsFlags {
  std::string folder;  // if empty, in the state folder
  double quota_gib = 10.0;
  double quota_each_gib = 0.0;  // 0 means half of it
  double keep_hours = 24.0;
  jobs::JobLimits limits;
};

void AddJobsFlags(CLI::App& serve, JobsFlags& flags);

// Returns the options of jobs from the flags and that state. Without a folder for results, there
// are no jobs.
jobs::JobsOptions JobsOptionsOf(const JobsFlags& flags, const State& state);

}  // namespace thunderhead::app
