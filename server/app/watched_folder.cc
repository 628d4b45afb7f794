#include "app/watched_folder.h"

#include <fnmatch.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "volume/storm_format.h"

namespace thunderhead::app {
namespace {

namespace fs = std::filesystem;

std::optional<pipeline::SeenFile> See(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  pipeline::SeenFile file;
  file.name = path.filename().string();
  file.bytes = static_cast<std::uint64_t>(status.st_size);
  file.modified_ns = std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
  file.changed =
      std::max(absl::TimeFromTimespec(status.st_mtim), absl::TimeFromTimespec(status.st_ctim));
  return file;
}

std::string NameOfFolder(const std::string& folder) {
  std::error_code error;
  const fs::path canonical = fs::canonical(folder, error);
  return (error ? fs::path(folder) : canonical).filename().string();
}

}  // namespace

absl::Status WatchedFolder::List(std::vector<pipeline::SeenFile>& files,
                                 std::vector<std::string>& names) const {
  std::error_code error;
  fs::directory_iterator entries(folder_, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    if (absl::StartsWith(name, ".") || absl::EndsWith(name, ".partial")) continue;
    names.push_back(name);
    if (policy_.IsMarker(name) || fnmatch(files_.c_str(), name.c_str(), 0) != 0) continue;
    if (auto seen = See(entries->path()); seen.has_value()) files.push_back(*std::move(seen));
  }
  if (!error) return absl::OkStatus();
  return absl::UnavailableError(
      absl::StrCat(folder_, ": the folder cannot be listed (", error.message(), ")"));
}

absl::Status WatchedFolder::Look(RunProgress& progress) {
  std::vector<pipeline::SeenFile> files;
  std::vector<std::string> names;
  THUNDERHEAD_RETURN_IF_ERROR(List(files, names));
  std::set<std::string> there;
  for (const pipeline::SeenFile& seen : files) {
    const std::string path = (fs::path(folder_) / seen.name).string();
    there.insert(path);
    File& file = known_[path];
    if (file.seen.bytes != seen.bytes || file.seen.modified_ns != seen.modified_ns) file = {};
    file.seen = seen;
    if (file.state != State::kWaiting || file.refused) continue;
    if (!policy_.WaitsFor(seen, files, names, absl::Now()).has_value()) {
      Open(path, file, progress);
    }
  }
  std::erase_if(known_, [&there](const auto& file) { return !there.contains(file.first); });
  return absl::OkStatus();
}

void WatchedFolder::Open(const std::string& path, File& file, RunProgress& progress) const {
  absl::StatusOr<volume::StormFile> storm = volume::StormFormats::BuiltIn().Describe(path);
  if (storm.ok()) {
    file.storm = *std::move(storm);
    file.state = State::kReady;
    return;
  }
  // Another program has it open: that passes without a change of the file.
  if (absl::IsUnavailable(storm.status())) return;
  file.refused = true;
  if (absl::IsInvalidArgument(storm.status())) file.state = State::kOther;
  progress.Note(path, absl::StrCat(file.state == State::kOther ? "left aside until it changes: "
                                                               : "waits until it changes: ",
                                   storm.status().message()));
}

std::vector<FolderStorm> WatchedFolder::Storms() const {
  std::vector<volume::StormFile> files;
  for (const auto& [path, file] : known_) {
    if (file.storm.has_value() && file.state != State::kBad) files.push_back(*file.storm);
  }
  std::vector<FolderStorm> storms;
  std::set<std::string> ids;
  for (std::vector<volume::StormFile>& run : volume::FilesOfRuns(std::move(files))) {
    std::string name = NameOfFolder(folder_);
    if (run.front().domain > 1) {
      absl::StrAppend(&name, "-d", absl::Dec(run.front().domain, absl::kZeroPad2));
    }
    FolderStorm& storm = storms.emplace_back();
    storm.storm = volume::AssembleStorm(name, std::move(run));
    std::string& id = storm.storm.info.id;
    storm.name = id;
    for (int copy = 2; !ids.insert(id).second; ++copy) id = absl::StrCat(storm.name, "-", copy);
  }
  return storms;
}

std::vector<std::string> WatchedFolder::Unsettled() const {
  std::vector<std::string> paths;
  for (const auto& [path, file] : known_) {
    if (file.state == State::kReady) paths.push_back(path);
  }
  return paths;
}

void WatchedFolder::Settle(const std::string& path, bool bad) {
  const auto file = known_.find(path);
  if (file != known_.end()) file->second.state = bad ? State::kBad : State::kDone;
}

bool WatchedFolder::IsDone(const std::string& path) const {
  const auto file = known_.find(path);
  return file != known_.end() && file->second.state == State::kDone;
}

int WatchedFolder::Count(State state) const {
  return static_cast<int>(std::ranges::count_if(
      known_, [state](const auto& file) { return file.second.state == state; }));
}

int WatchedFolder::DoneCount() const { return Count(State::kDone); }
int WatchedFolder::BadCount() const { return Count(State::kBad); }
int WatchedFolder::WaitingCount() const { return Count(State::kWaiting) + Count(State::kReady); }

}  // namespace thunderhead::app
