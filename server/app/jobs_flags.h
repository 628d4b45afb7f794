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
  std::string folder;  // folder for results; if empty, a folder in the state folder
  double quota_gib = 10.0;
  double quota_each_gib = 0.0;  // quota of one owner; 0 means half of quota_gib
  double keep_hours = 24.0;
  jobs::JobLimits limits;
};

void AddJobsFlags(CLI::App& serve, JobsFlags& flags);

// Returns the options of render jobs from the flags and the state. Without a folder for results,
// the server keeps no jobs.
jobs::JobsOptions JobsOptionsOf(const JobsFlags& flags, const State& state);

}  // namespace thunderhead::app
