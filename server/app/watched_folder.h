// A folder that a model writes to. It finds the complete files and groups them as times of storms.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "app/confined_formats.h"
#include "app/run_progress.h"
#include "pipeline/manifest.h"
#include "pipeline/readiness.h"
#include "storm_files/storm_file.h"
#include "storm_store/storm_catalogue.h"

namespace thunderhead::app {

// A storm of a folder, with a name that stays the same as more files arrive.
struct FolderStorm {
  std::string name;
  storm_store::CataloguedStorm storm;
};

class WatchedFolder {
 public:
  // `files` is a pattern for the names of data files, as in fnmatch(3).
  WatchedFolder(std::string folder, std::string files, pipeline::ReadinessPolicy policy)
      : folder_(std::move(folder)), files_(std::move(files)), policy_(std::move(policy)) {}

  // Checks the folder and opens the files that have become ready. A file that changes starts again.
  // Returns UNAVAILABLE if the folder cannot be listed.
  absl::Status Look(RunProgress& progress);

  // Returns the storms of all files that are ready.
  std::vector<FolderStorm> Storms() const;

  // Returns the files that are ready and not settled yet, by path.
  std::vector<std::string> Unsettled() const;
  // Settles a file: all of its pictures are made. If `bad`, they cannot be made until the file
  // changes.
  void Settle(const std::string& path, bool bad);

  // Counts a file as done because an earlier run has drawn it. That ends if the file appears again.
  void RememberDone(const pipeline::InputFile& file);

  bool IsDone(const std::string& path) const;
  // Returns the number of files that are done. Drawn files that were removed, for example into an
  // archive, count as well.
  int DoneCount() const;
  // Returns the number of files that cannot be drawn in their current state.
  int BadCount() const;
  // Returns the number of existing files that are not ready or not settled.
  int WaitingCount() const;

 private:
  enum class State { kWaiting, kOther, kReady, kDone, kBad };

  using Time = std::chrono::steady_clock::time_point;

  struct File {
    pipeline::SeenFile seen;
    Time unchanged_since;
    bool gone = false;  // true if it was drawn or found bad before it was removed
    State state = State::kWaiting;
    bool refused = false;  // true if it does not open, so that it waits for a change
    std::optional<storm_files::StormFile> storm;
  };

  absl::Status List(std::vector<pipeline::SeenFile>& files, std::vector<std::string>& names,
                    Time now);
  void See(const std::string& path, pipeline::SeenFile& seen, std::int64_t changed_ns, Time now);
  // Marks files that are not in `there` as gone. Removes those that are not settled, and those that
  // now exist under another name.
  void ForgetGone(const std::set<std::string>& there);
  void Open(const std::string& path, File& file, RunProgress& progress) const;
  int Count(State state) const;

  const std::string folder_;
  const std::string files_;
  const pipeline::ReadinessPolicy policy_;
  const storm_files::StormFormats formats_ = ConfinedFormats();
  Time looked_ = Time::min();          // time of the last check
  std::map<std::string, File> known_;  // by path
};

}  // namespace thunderhead::app
