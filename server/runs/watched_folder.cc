#include "runs/watched_folder.h"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/file_stamp.h"
#include "base/status.h"
#include "runs/local_service.h"

namespace thunderhead::runs {
namespace {

namespace fs = std::filesystem;

std::string NameOfFolder(const std::string& folder) {
  std::error_code error;
  const fs::path canonical = fs::canonical(folder, error);
  return (error ? fs::path(folder) : canonical).filename().string();
}

}  // namespace

absl::Status WatchedFolder::List(std::vector<pipeline::SeenFile>& files,
                                 std::vector<std::string>& names, Time now) {
  std::error_code error;
  fs::directory_iterator entries(folder_, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    if (absl::StartsWith(name, ".") || absl::EndsWith(name, ".partial")) continue;
    names.push_back(name);
    if (policy_.IsMarker(name) || fnmatch(files_.c_str(), name.c_str(), 0) != 0) continue;
    std::error_code ignored;
    if (!entries->is_regular_file(ignored)) continue;
    const auto stamp = base::StampOf(entries->path().string());
    if (!stamp.has_value()) continue;
    pipeline::SeenFile& seen = files.emplace_back();
    seen.name = name;
    seen.bytes = static_cast<std::uint64_t>(stamp->size_bytes);
    seen.modified_ns = stamp->modified_ns;
    // The later of the two times is used, because `cp -p` and rsync set the modification time back.
    See((fs::path(folder_) / name).string(), seen, std::max(stamp->modified_ns, stamp->changed_ns),
        now);
  }
  if (!error) return absl::OkStatus();
  return absl::UnavailableError(
      absl::StrCat(folder_, ": the folder cannot be listed (", error.message(), ")"));
}

void WatchedFolder::See(const std::string& path, pipeline::SeenFile& seen, std::int64_t changed_ns,
                        Time now) {
  const auto [entry, fresh] = known_.try_emplace(path);
  File& file = entry->second;
  if (fresh || file.gone || file.seen.bytes != seen.bytes ||
      file.seen.modified_ns != seen.modified_ns) {
    file = {};
    file.unchanged_since = base::UnchangedSince(changed_ns, looked_, now);
  }
  seen.unchanged = absl::FromChrono(now - file.unchanged_since);
  file.seen = seen;
}

absl::Status WatchedFolder::Look(RunProgress& progress) {
  std::vector<pipeline::SeenFile> files;
  std::vector<std::string> names;
  const Time now = std::chrono::steady_clock::now();
  THUNDERHEAD_RETURN_IF_ERROR(List(files, names, now));
  looked_ = now;
  std::set<std::string> there;
  for (const pipeline::SeenFile& seen : files) {
    if (stop_.stop_requested()) return absl::CancelledError("interrupted");
    const std::string path = (fs::path(folder_) / seen.name).string();
    there.insert(path);
    File& file = known_.at(path);
    if (file.state != State::kWaiting || file.refused) continue;
    if (!policy_.WaitsFor(seen, files, names).has_value()) {
      Open(path, file, progress);
    }
  }
  ForgetGone(there);
  return absl::OkStatus();
}

void WatchedFolder::ForgetGone(const std::set<std::string>& there) {
  std::set<std::pair<std::uint64_t, std::int64_t>> here;
  for (auto& [path, file] : known_) {
    if (there.contains(path)) {
      here.emplace(file.seen.bytes, file.seen.modified_ns);
    } else {
      file.gone = true;
      file.storm.reset();
    }
  }
  std::erase_if(known_, [&here](const auto& entry) {
    const File& file = entry.second;
    const bool settled = file.state == State::kDone || file.state == State::kBad;
    const bool renamed = here.contains({file.seen.bytes, file.seen.modified_ns});
    return file.gone && (!settled || renamed);
  });
}

void WatchedFolder::Open(const std::string& path, File& file, RunProgress& progress) const {
  absl::StatusOr<storm_files::StormFile> storm = storm_store::DescribeFile(path, formats_);
  if (storm.ok() && !storm->part.of.empty()) {
    storm = absl::InvalidArgumentError(absl::StrCat(
        path,
        ": is one of several files of a time, which are not watched; give the folder to "
        "thunderhead sequence when all files of the time are there"));
  }
  if (storm.ok()) {
    file.storm = *std::move(storm);
    file.state = State::kReady;
    return;
  }
  // The file may be open in another program. It may become readable without a change, so it is not
  // marked as refused.
  if (absl::IsUnavailable(storm.status()) || absl::IsCancelled(storm.status())) return;
  file.refused = true;
  const char* what = "waits until it changes: ";
  if (absl::IsInvalidArgument(storm.status())) {
    file.state = State::kOther;
    what = "ignored until it changes: ";
  } else if (IsLastingRefusal(storm.status())) {
    file.state = State::kBad;
    what = "cannot be drawn until it changes: ";
  }
  progress.Note(path, absl::StrCat(what, storm.status().message()));
}

std::vector<FolderStorm> WatchedFolder::Storms() const {
  std::vector<storm_files::StormFile> files;
  for (const auto& [path, file] : known_) {
    if (file.storm.has_value() && file.state != State::kBad) files.push_back(*file.storm);
  }
  std::vector<FolderStorm> storms;
  std::set<std::string> ids;
  for (std::vector<storm_files::StormFile>& run : storm_store::FilesOfRuns(std::move(files))) {
    std::string name = NameOfFolder(folder_);
    if (run.front().domain > 1) {
      absl::StrAppend(&name, "-d", absl::Dec(run.front().domain, absl::kZeroPad2));
    }
    FolderStorm& storm = storms.emplace_back();
    storm.storm = storm_store::AssembleStorm(name, std::move(run));
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

void WatchedFolder::RememberDone(const pipeline::InputFile& file) {
  const std::string name = fs::path(file.path).filename().string();
  if ((fs::path(folder_) / name).string() != file.path ||
      fnmatch(files_.c_str(), name.c_str(), 0) != 0) {
    return;
  }
  File& known = known_[file.path];
  known.seen.bytes = file.bytes;
  known.seen.modified_ns = file.modified_ns;
  known.state = State::kDone;
  known.gone = true;
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

}  // namespace thunderhead::runs
