#include "app/jobs_flags.h"

#include <chrono>
#include <cmath>
#include <cstdint>

namespace thunderhead::app {
namespace {

constexpr char kGroup[] = "Render jobs";

}  // namespace

void AddJobsFlags(CLI::App& serve, JobsFlags& flags) {
  const auto add = [&serve](const std::string& name, auto& value, double least, double most,
                            const std::string& help) {
    serve.add_option(name, value, help)
        ->check(CLI::Range(least, most))
        ->capture_default_str()
        ->group(kGroup);
  };
  serve
      .add_option("--jobs-folder", flags.folder,
                  "Folder for the results of render jobs, which only this server may use; by "
                  "default the folder jobs in the folder of --state")
      ->group(kGroup);
  add("--jobs-quota", flags.quota_gib, 1e-6, 1e6,
      "Maximum GiB of results that are kept; beyond it the oldest fetched results are deleted, and "
      "if none was fetched, no further picture is begun");
  add("--jobs-quota-each", flags.quota_each_gib, 0, 1e6,
      "Maximum GiB of results of one identity that were not fetched; beyond it none of its "
      "pictures is begun; 0 for half of --jobs-quota");
  add("--jobs-keep", flags.keep_hours, 1e-4, 1e5,
      "Hours for which an ended job is kept with its results; a paused job ends after the same "
      "time without a picture drawn or fetched");
  add("--max-jobs", flags.limits.max_jobs, 1, 1e5,
      "Maximum number of jobs; ended jobs whose results were fetched are forgotten to accept a new "
      "job");
  add("--max-jobs-each", flags.limits.max_jobs_per_owner, 1, 1e5,
      "Maximum number of jobs of one identity");
  add("--max-job-pictures", flags.limits.max_pictures, 1, 1e6,
      "Maximum number of pictures of jobs that wait to be drawn");
  add("--max-job-pictures-each", flags.limits.max_pictures_per_owner, 1, 1e6,
      "Maximum number of pictures of one identity's jobs that wait to be drawn");
  add("--max-kept-pictures", flags.limits.max_kept_pictures, 1, 1e7,
      "Maximum number of pictures of all kept jobs, drawn or not");
  add("--max-kept-pictures-each", flags.limits.max_kept_pictures_per_owner, 1, 1e7,
      "Maximum number of pictures of one identity's kept jobs, drawn or not");
}

jobs::JobsOptions JobsOptionsOf(const JobsFlags& flags, const State& state) {
  jobs::JobsOptions options;
  options.store = state.jobs;
  options.folder = flags.folder;
  if (options.folder.empty() && !state.folder.empty()) options.folder = state.folder + "/jobs";
  options.limits = flags.limits;
  const auto bytes = [](double gib) {
    return static_cast<std::uint64_t>(gib * static_cast<double>(1 << 30));
  };
  options.limits.max_result_bytes = bytes(flags.quota_gib);
  options.limits.max_result_bytes_per_owner =
      bytes(flags.quota_each_gib > 0.0 ? flags.quota_each_gib : 0.5 * flags.quota_gib);
  options.limits.keep = std::chrono::seconds(std::llround(3600.0 * flags.keep_hours));
  return options;
}

}  // namespace thunderhead::app
