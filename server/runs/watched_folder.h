// A folder that a model writes to. Finds its complete files and groups them into storms with their
// times.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pipeline/manifest.h"
#include "pipeline/readiness.h"
#include "runs/run_progress.h"
#include "sandbox/confined_files.h"
#include "storm_files/storm_file.h"
#include "storm_store/storm_catalogue.h"

namespace thunderhead::runs {

// A storm of the folder. Its name stays the same when more files arrive.
struct FolderStorm {
  std::string name;
  storm_store::CataloguedStorm storm;
};

class WatchedFolder {
 public:
  // `files` is a pattern for the names of data files, as in fnmatch(3). A request to stop ends a
  // file's reader.
  WatchedFolder(std::string folder, std::string files, pipeline::ReadinessPolicy policy,
                std::stop_token stop)
      : folder_(std::move(folder)),
        files_(std::move(files)),
        policy_(std::move(policy)),
        stop_(std::move(stop)) {}

  // Scans the folder and opens the files that have become ready. A file that has changed is treated
  // as new. UNAVAILABLE if the folder cannot be listed. CANCELLED if a stop is requested.
  absl::Status Look(RunProgress& progress);

  // Returns the storms of all files that are ready.
  std::vector<FolderStorm> Storms() const;

  // Returns the paths of the files that are ready but not settled yet.
  std::vector<std::string> Unsettled() const;
  // Settles a file: all its pictures are made or, if `bad`, cannot be made until the file changes.
  void Settle(const std::string& path, bool bad);

  // Counts a file as done because an earlier run has drawn it. If the file is found in the folder
  // again, it is treated as a new file.
  void RememberDone(const pipeline::InputFile& file);

  bool IsDone(const std::string& path) const;
  // Returns the number of files that are done. Drawn files that were removed, for example to an
  // archive, are included.
  int DoneCount() const;
  // Returns the number of files that cannot be drawn in their current state.
  int BadCount() const;
  // Returns the number of existing files that are not ready yet or not settled yet.
  int WaitingCount() const;

 private:
  enum class State { kWaiting, kOther, kReady, kDone, kBad };

  using Time = std::chrono::steady_clock::time_point;

  struct File {
    pipeline::SeenFile seen;
    Time unchanged_since;
    bool gone = false;  // true if the file was removed after it was drawn or found bad
    State state = State::kWaiting;
    // True if the file could not be opened, so that it is not tried again until it changes.
    bool refused = false;
    std::optional<storm_files::StormFile> storm;
  };

  absl::Status List(std::vector<pipeline::SeenFile>& files, std::vector<std::string>& names,
                    Time now);
  void See(const std::string& path, pipeline::SeenFile& seen, std::int64_t changed_ns, Time now);
  // Marks files that are not in `there` as gone. Forgets those that are not settled, and those that
  // now exist under another name.
  void ForgetGone(const std::set<std::string>& there);
  void Open(const std::string& path, File& file, RunProgress& progress) const;
  int Count(State state) const;

  const std::string folder_;
  const std::string files_;
  const pipeline::ReadinessPolicy policy_;
  const std::stop_token stop_;
  const storm_files::StormFormats formats_ = sandbox::ConfinedFormats({.limits = {.stop = stop_}});
  Time looked_ = Time::min();          // time of the last check
  std::map<std::string, File> known_;  // by path
};

}  // namespace thunderhead::runs
