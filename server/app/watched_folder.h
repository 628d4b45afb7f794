// A folder that a model writes to: finds which of its files are complete, and groups these as times
// of storms.
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

// A storm of a folder, under a name that stays the same as its files come.
struct FolderStorm {
  std::string name;
  storm_store::CataloguedStorm storm;
};

class WatchedFolder {
 public:
  // `files` is a pattern of the names of data files, as fnmatch(3).
  WatchedFolder(std::string folder, std::string files, pipeline::ReadinessPolicy policy)
      : folder_(std::move(folder)), files_(std::move(files)), policy_(std::move(policy)) {}

  // Looks at the folder and opens the files that have become ready. A file that changes begins
  // again. UNAVAILABLE if the folder cannot be listed.
  absl::Status Look(RunProgress& progress);

  // The storms of all files that are ready.
  std::vector<FolderStorm> Storms() const;

  // Files that are ready and not settled yet, by path.
  std::vector<std::string> Unsettled() const;
  // All of a file's pictures are made, or, if `bad`, never will be as long as it does not change.
  void Settle(const std::string& path, bool bad);

  // Counts a file as done that an earlier run has drawn, for as long as it is not there (again).
  void RememberDone(const pipeline::InputFile& file);

  bool IsDone(const std::string& path) const;
  // Files that are gone since they were drawn, as into an archive, count as well.
  int DoneCount() const;
  // Files that cannot be drawn as they are.
  int BadCount() const;
  // Files that are there but not ready, or not settled.
  int WaitingCount() const;

 private:
  enum class State { kWaiting, kOther, kReady, kDone, kBad };

  using Time = std::chrono::steady_clock::time_point;

  struct File {
    pipeline::SeenFile seen;
    Time unchanged_since;
    bool gone = false;  // when it had been drawn or found bad
    State state = State::kWaiting;
    bool refused = false;  // waits for a change, as it does not open
    std::optional<storm_files::StormFile> storm;
  };

  absl::Status List(std::vector<pipeline::SeenFile>& files, std::vector<std::string>& names,
                    Time now);
  void See(const std::string& path, pipeline::SeenFile& seen, std::int64_t changed_ns, Time now);
  // Marks files that are not `there` any more as gone. Forgets those of them that are not done yet,
  // and those that are there under another name.
  void ForgetGone(const std::set<std::string>& there);
  void Open(const std::string& path, File& file, RunProgress& progress) const;
  int Count(State state) const;

  const std::string folder_;
  const std::string files_;
  const pipeline::ReadinessPolicy policy_;
  const storm_files::StormFormats formats_ = ConfinedFormats();
  Time looked_ = Time::min();          // of the last look
  std::map<std::string, File> known_;  // by path
};

}  // namespace thunderhead::app
