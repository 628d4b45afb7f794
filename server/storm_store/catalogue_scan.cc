#include "storm_store/catalogue_scan.h"

#include <algorithm>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>

#include "base/file_stamp.h"
#include "base/slow_calls.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::storm_store {
namespace {

// Returns whether times were appended to a file since it was described. Otherwise the file was
// written anew.
bool GoesOn(const storm_files::StormFile& before, const storm_files::StormFile& after) {
  // More times of one storm shift the records of the next ones.
  if (!before.others.empty() || !after.others.empty()) return false;
  return after.times.size() > before.times.size() &&
         std::ranges::equal(before.times, std::span(after.times).first(before.times.size()));
}

}  // namespace

std::optional<CatalogueScan::Stamp> CatalogueScan::StampOf(const std::string& path) {
  const base::SlowCall call(path);
  const std::optional<base::FileStamp> found = base::StampOf(path);
  if (!found.has_value()) return std::nullopt;
  return Stamp{found->Id(), static_cast<std::uint64_t>(found->size_bytes), found->modified_ns};
}

absl::StatusOr<CatalogueScan::Result> CatalogueScan::Scan(Time now) {
  ++scans_;
  changed_ = scans_ == 1;
  look_again_at_.reset();
  Result result;
  const StormSearch search{
      .describe = [this,
                   now](const std::vector<std::string>& paths) { return Describe(paths, now); },
      .describe_together =
          [this](const std::vector<std::string>& paths) { return DescribeTogether(paths); },
      .may_find_nothing = true,
      .on_unlisted =
          [this](const std::string& path, const absl::Status& status) {
            if (!unlisted_.insert(path).second) return;
            spdlog::warn("left out: {}", std::string(status.message()));
          },
      .on_folder = [&result](const std::string& path) { result.folders.push_back(path); },
      .examples = options_.formats.Examples(),
      .answers = [this](const std::string& path) { return Answers(path); },
      .found = &found_,
      .links = options_.links};
  absl::StatusOr<std::vector<CataloguedStorm>> storms = FindStorms(options_.paths, search);
  // A scan that was stopped has not seen every file, so its storms must not replace the others.
  if (stopping_) return absl::CancelledError("the search for storms was told to stop");
  THUNDERHEAD_ASSIGN_OR_RETURN(result.storms, std::move(storms));
  const std::size_t gone = std::erase_if(known_, [this](const auto& entry) {
    const auto hangs = [&entry](const std::string& path) { return entry.first.starts_with(path); };
    return entry.second.scan != scans_ && std::ranges::none_of(hanging_, hangs);
  });
  std::erase_if(together_, [this](const auto& entry) {
    return hanging_.empty() && entry.second.scan != scans_;
  });
  result.changed = changed_ || gone > 0;
  if (result.changed) LogNotes(result.storms);
  result.look_again_at = look_again_at_;
  return result;
}

void CatalogueScan::LookAtFolder(const std::string& path) {
  std::error_code error;
  const std::filesystem::directory_iterator entries(path, error);
  if (!error && entries != std::filesystem::directory_iterator()) {
    (void)base::StampOf(entries->path().string());
  }
}

bool CatalogueScan::Answers(const std::string& path) {
  const absl::Status hangs = calls_.Run(path, [path, look = options_.look_at] { look(path); });
  if (hangs.ok()) {
    if (hanging_.erase(path) > 0) spdlog::info("{} answers again", path);
    return true;
  }
  if (hanging_.insert(path).second) {
    spdlog::warn("{}; its storms stay as they were", std::string(hangs.message()));
  }
  return false;
}

std::vector<absl::StatusOr<storm_files::StormFile>> CatalogueScan::Describe(
    const std::vector<std::string>& paths, Time now) {
  std::vector<std::string> to_open;
  for (const std::string& path : paths) {
    if (stopping_) break;
    const std::optional<Stamp> stamp = StampOf(path);
    if (!stamp.has_value()) continue;
    Known& known = known_[path];
    if (Look(*stamp, now, known)) to_open.push_back(path);
    known.scan = scans_;
  }
  std::vector<absl::StatusOr<storm_files::StormFile>> opened =
      DescribeInBatches(to_open, options_.formats, [this] {
        if (!stopping_) options_.before_file();
        return !stopping_;
      });
  for (std::size_t i = 0; i < to_open.size() && !stopping_; ++i) {
    Take(to_open[i], now, std::move(opened[i]), known_[to_open[i]]);
  }
  std::vector<absl::StatusOr<storm_files::StormFile>> files;
  for (const std::string& path : paths) {
    const auto known = known_.find(path);
    if (known == known_.end() || known->second.scan != scans_) {
      files.emplace_back(absl::CancelledError("it has just gone"));
    } else if (known->second.description.has_value()) {
      files.emplace_back(*known->second.description);
    } else {
      files.emplace_back(absl::CancelledError(known->second.settled ? "it is no storm"
                                                                    : "it is still being written"));
    }
  }
  return files;
}

absl::StatusOr<storm_files::StormFile> CatalogueScan::DescribeTogether(
    const std::vector<std::string>& paths) {
  if (stopping_) return absl::CancelledError("the search was told to stop");
  std::vector<std::uint64_t> versions;
  versions.reserve(paths.size());
  for (const std::string& path : paths) versions.push_back(known_[path].description->version);
  KnownTogether& known = together_[paths];
  known.scan = scans_;
  if (known.versions == versions) {
    // An error is logged once.
    if (!known.description.ok()) return absl::CancelledError("it is still not whole");
    return *known.description;
  }
  known.versions = std::move(versions);
  options_.before_file();
  known.description = options_.formats.DescribeTogether(paths);
  changed_ = true;
  if (!known.description.ok()) return known.description.status();
  storm_files::StormFile& file = *known.description;
  const storm_files::StormFile& first = *known_[paths.front()].description;
  file.version = ++versions_;
  file.id = first.id;
  file.device = first.device;
  return file;
}

bool CatalogueScan::Look(const Stamp& stamp, Time now, Known& known) {
  const bool fresh = known.scan == 0;
  if (fresh || known.stamp != stamp) {
    const bool same_file = !fresh && known.stamp.file == stamp.file;
    const bool grows = same_file && known.stamp.size_bytes <= stamp.size_bytes;
    // If a file replaced another one in one step, the old times stay listed until the new file has
    // been read. If the new file is still being written, it did not replace the old file in one
    // step. Then no times are listed until the new file is complete.
    const bool written = same_file && known.replaces;
    if ((same_file && !grows) || written) Lose(known);
    known.replaces = !same_file && known.description.has_value();
    known.stamp = stamp;
    known.unchanged_since = now;
    // A file that the first scan finds may be old enough to count as complete at once. For all
    // other files the settling time starts now, so that new files of one folder become complete
    // together. If one of them were complete first, it would become a storm with a different name.
    known.settled =
        fresh && scans_ == 1 &&
        now - base::UnchangedSince(stamp.changed_ns, Time::min(), now) >= options_.settle;
    known.tried_at.reset();
  }
  if (!known.settled && now - known.unchanged_since < options_.settle) {
    LookAgainAt(known.unchanged_since + options_.settle);
    return false;
  }
  known.settled = true;
  return MustOpen(now, known);
}

bool CatalogueScan::MustOpen(Time now, const Known& known) const {
  if (!known.tried_at.has_value()) return true;
  return !known.complaint.empty() && now - *known.tried_at >= options_.retry;
}

void CatalogueScan::Take(const std::string& path, Time now,
                         absl::StatusOr<storm_files::StormFile> file, Known& known) {
  known.tried_at = now;
  // The file was being written while it was read, so its description is out of date.
  if (StampOf(path) != known.stamp) {
    known.tried_at.reset();
    known.settled = false;
    known.unchanged_since = now;
    return LookAgainAt(now + options_.settle);
  }
  if (file.ok()) {
    const bool goes_on =
        known.description.has_value() && !known.replaces && GoesOn(*known.description, *file);
    file->version = goes_on ? known.description->version : ++versions_;
    file->id = known.stamp.file;
    known.description = *std::move(file);
    known.replaces = false;
    known.complaint.clear();
    changed_ = true;
    return;
  }
  if (std::exchange(known.replaces, false)) Lose(known);
  const std::string complaint(file.status().message());
  if (complaint == known.complaint) return;
  known.complaint = complaint;
  // A file of another kind, such as a read-me, is normal.
  const bool other = absl::IsInvalidArgument(file.status());
  spdlog::log(other ? spdlog::level::info : spdlog::level::warn, "left out: {}", complaint);
}

void CatalogueScan::Lose(Known& known) {
  changed_ = changed_ || known.description.has_value();
  known.description.reset();
}

void CatalogueScan::LookAgainAt(Time time) {
  look_again_at_ = std::min(look_again_at_.value_or(time), time);
}

}  // namespace thunderhead::storm_store
