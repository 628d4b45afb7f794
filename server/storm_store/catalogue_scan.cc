#include "storm_store/catalogue_scan.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <span>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/file_stamp.h"
#include "base/slow_calls.h"
#include "base/status.h"
#include "spdlog/spdlog.h"

namespace thunderhead::storm_store {
namespace {

double Seconds(CatalogueScan::Time::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

// Returns whether times were appended to a file since it was described. Otherwise the file was
// written anew.
bool GoesOn(const storm_files::StormFile& before, const storm_files::StormFile& after) {
  // If a file has several storms, additional times of one storm shift the record numbers of the
  // next ones.
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
  now_ = now;
  changed_ = scans_ == 1;
  is_unfinished_ = false;
  has_untried_ = false;
  look_again_at_.reset();
  BeginTogether();
  const Time began = options_.time->Now();
  Result result;
  const StormSearch search{
      .describe = [this](const std::vector<std::string>& paths) { return Descriptions(paths); },
      .describe_together =
          [this](const std::vector<std::string>& paths) { return DescribeTogether(paths); },
      .may_find_nothing = true,
      .on_unlisted = [this](const std::string&,
                            const absl::Status& status) { ReportOnce(status, true); },
      .on_folder = [&result](const std::string& path) { result.folders.push_back(path); },
      .examples = options_.formats.Examples(),
      .answers = [this](const std::string& path) { return Answers(path); },
      .found = &found_,
      .links = options_.links,
      .prepare =
          [this, began](const std::vector<ListedFolder>& folders) {
            See(folders);
            const Time seen = options_.time->Now();
            turn_ends_ = seen + std::max<Time::duration>(options_.turn, seen - began);
            DescribeWaiting();
          },
      .on_left_out = [this](const absl::Status& why) { ReportOnce(why, false); },
      .known_below = [this](const std::string& folder) { return KnownBelow(folder); },
      .most_entries = options_.most_entries};
  absl::StatusOr<std::vector<CataloguedStorm>> storms = FindStorms(options_.paths, search);
  // A scan that was stopped has not seen every file, so its storms must not replace the others.
  if (stopping_) return absl::CancelledError("the search for storms was stopped");
  THUNDERHEAD_ASSIGN_OR_RETURN(result.storms, std::move(storms));
  result.changed = ForgetUnseen() || changed_;
  EndTurn(result);
  if (result.changed) LogNotes(result.storms, &reported_);
  result.look_again_at = look_again_at_;
  return result;
}

// Forgets the files that the scan has not seen, except those whose storage hangs. Returns whether
// any file was forgotten.
bool CatalogueScan::ForgetUnseen() {
  const std::size_t gone = std::erase_if(known_, [this](const auto& entry) {
    const auto hangs = [&entry](const std::string& path) { return entry.first.starts_with(path); };
    return entry.second.scan != scans_ && std::ranges::none_of(hanging_, hangs);
  });
  std::erase_if(together_, [this](const auto& entry) {
    return hanging_.empty() && entry.second.scan != scans_;
  });
  return gone > 0;
}

// Records in `result` what waits for the next scan.
void CatalogueScan::EndTurn(Result& result) {
  result.has_untried =
      has_untried_ || !waiting_together_.empty() ||
      std::ranges::any_of(waiting_, [](const auto& entry) { return entry.second.HasUntried(); });
  result.is_unfinished = is_unfinished_ || result.has_untried || !waiting_.empty();
  FolderSet all = waiting_together_;
  for (const auto& [folder, waiting] : waiting_) all.insert(folder);
  turns_.KeepOnly(all);
  left_out_.Summarize(now_);
  // Other users can create any number of files, each with its own reason, so the set is limited.
  constexpr std::size_t kMostReported = 10'000;
  if (reported_.size() > kMostReported) reported_.clear();
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

void CatalogueScan::ReportOnce(const absl::Status& why, bool is_warning) {
  const std::string reason(why.message());
  if (!reported_.insert(reason).second) return;
  // A file of another kind, such as a read-me, is normal and needs no warning.
  left_out_.Add(reason, is_warning || !absl::IsInvalidArgument(why), now_);
}

std::vector<std::string> CatalogueScan::KnownBelow(const std::string& folder) const {
  const std::string below = folder.ends_with('/') ? folder : folder + "/";
  std::vector<std::string> paths;
  for (auto at = known_.lower_bound(below); at != known_.end() && at->first.starts_with(below);
       ++at) {
    if (at->second.description.has_value()) paths.push_back(at->first);
  }
  return paths;
}

// Examines all files, and notes which of them must be opened.
void CatalogueScan::See(const std::vector<ListedFolder>& folders) {
  waiting_.clear();
  // Files that the user gave one by one may be in the same folder.
  for (const ListedFolder& folder : folders) {
    for (const std::string& path : folder.files) {
      if (stopping_) return;
      if (!See(path)) continue;
      const Known& known = known_[path];
      const bool is_untried = known.tries == 0 && known.trial != Trial::kPatient;
      Waiting& waiting = waiting_[folder.path];
      (is_untried ? waiting.untried : waiting.tried).push_back(path);
    }
  }
  for (auto& [folder, waiting] : waiting_) {
    std::ranges::stable_sort(waiting.tried, {},
                             [this](const std::string& path) { return known_[path].tries; });
  }
}

bool CatalogueScan::See(const std::string& path) {
  const std::optional<Stamp> stamp = StampOf(path);
  if (!stamp.has_value()) return false;
  Known& known = known_[path];
  // A path may be given twice.
  if (known.scan == scans_) return false;
  const bool must_open = Look(*stamp, known);
  known.scan = scans_;
  if (!must_open || stamp->size_bytes > 0) return must_open;
  Take(path,
       absl::InvalidArgumentError(absl::StrCat(path, ": is empty; write it again, or remove it")),
       known);
  return false;
}

void CatalogueScan::DescribeWaiting() {
  bool has_described = false;
  FolderSet folders;
  for (const auto& [folder, waiting] : waiting_) folders.insert(folder);
  while (!folders.empty() && !stopping_) {
    if (has_described && options_.time->Now() >= turn_ends_) return;
    const std::string folder = turns_.Next(folders);
    Waiting& waiting = waiting_[folder];
    // The storms found so far are published before the long wait for a slow file.
    const bool is_slow =
        !waiting.HasUntried() && known_[waiting.tried[waiting.next_tried]].trial == Trial::kPatient;
    if (has_described && is_slow) return;
    const std::vector<std::string> batch = NextBatch(waiting);
    if (waiting.IsEmpty()) {
      waiting_.erase(folder);
      folders.erase(folder);
    }
    options_.before_file();
    if (stopping_) return;
    const Time began = options_.time->Now();
    DescribeBatch(batch);
    turns_.Used(folder, Seconds(options_.time->Now() - began));
    has_described = true;
  }
}

std::vector<std::string> CatalogueScan::NextBatch(Waiting& waiting) {
  if (!waiting.HasUntried()) return {waiting.tried[waiting.next_tried++]};
  const auto is_alone = [this](const std::string& path) {
    return known_[path].trial != Trial::kBatch;
  };
  const auto first = waiting.untried.begin() + static_cast<std::ptrdiff_t>(waiting.next_untried);
  auto end = waiting.untried.begin() +
             static_cast<std::ptrdiff_t>(EndOfBatch(waiting.untried, waiting.next_untried));
  end = is_alone(*first) ? first + 1 : std::find_if(first, end, is_alone);
  waiting.next_untried += static_cast<std::size_t>(end - first);
  return {first, end};
}

void CatalogueScan::DescribeBatch(const std::vector<std::string>& batch) {
  const bool is_patient = batch.size() == 1 && known_[batch.front()].trial == Trial::kPatient;
  std::vector<absl::StatusOr<storm_files::StormFile>> described = storm_store::DescribeBatch(
      batch, options_.formats, is_patient ? storm_files::kLongestDescription : options_.trial);
  for (std::size_t i = 0; i < batch.size() && !stopping_; ++i) {
    Known& known = known_[batch[i]];
    if (!absl::IsAborted(described[i].status())) {
      Take(batch[i], std::move(described[i]), known);
      continue;
    }
    known.trial = batch.size() == 1 ? Trial::kPatient : Trial::kAlone;
    is_unfinished_ = true;
    has_untried_ = has_untried_ || batch.size() > 1;
  }
}

std::vector<absl::StatusOr<storm_files::StormFile>> CatalogueScan::Descriptions(
    const std::vector<std::string>& paths) {
  std::vector<absl::StatusOr<storm_files::StormFile>> files;
  for (const std::string& path : paths) {
    const auto known = known_.find(path);
    if (known == known_.end() || known->second.scan != scans_) {
      files.emplace_back(absl::CancelledError("it was just removed"));
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
  if (stopping_) return absl::CancelledError("the search was stopped");
  std::vector<std::uint64_t> versions;
  versions.reserve(paths.size());
  for (const std::string& path : paths) versions.push_back(known_[path].description->version);
  KnownTogether& known = together_[paths];
  known.scan = scans_;
  if (known.versions != versions) DescribeTogether(paths, std::move(versions), known);
  // DescribeTogether has already logged the error. The caller does not log a CANCELLED error.
  if (!known.description.ok()) return absl::CancelledError("its files are still incomplete");
  return *known.description;
}

// Chooses the folders in which this scan may describe times that are spread over several files.
void CatalogueScan::BeginTogether() {
  constexpr std::size_t kMostServed = 16;
  FolderSet waited = std::exchange(waiting_together_, {});
  together_ends_.reset();
  served_together_.clear();
  first_together_.clear();
  had_waited_together_ = !waited.empty();
  while (!waited.empty() && served_together_.size() < kMostServed) {
    const std::string next = turns_.Next(waited);
    if (served_together_.empty()) first_together_ = next;
    served_together_.insert(next);
    waited.erase(next);
  }
}

bool CatalogueScan::MayDescribeTogether(const std::string& folder) {
  const Time now = options_.time->Now();
  // Each scan may describe at least one time that is spread over several files.
  const bool is_certain =
      had_waited_together_ ? folder == first_together_ : !together_ends_.has_value();
  if (!together_ends_.has_value()) together_ends_ = now + options_.turn;
  if (is_certain) {
    first_together_.clear();
    return true;
  }
  const bool is_served = !had_waited_together_ || served_together_.contains(folder);
  return is_served && now < *together_ends_;
}

// Describes the files again. If they must wait, their old description stays.
void CatalogueScan::DescribeTogether(const std::vector<std::string>& paths,
                                     std::vector<std::uint64_t> versions, KnownTogether& known) {
  const std::string folder = std::filesystem::path(paths.front()).parent_path().string();
  if (!MayDescribeTogether(folder)) {
    waiting_together_.insert(folder);
    return;
  }
  known.versions = std::move(versions);
  options_.before_file();
  const Time began = options_.time->Now();
  known.description = options_.formats.DescribeTogether(paths);
  turns_.Used(folder, Seconds(options_.time->Now() - began));
  changed_ = true;
  if (!known.description.ok()) return ReportOnce(known.description.status(), false);
  storm_files::StormFile& file = *known.description;
  const storm_files::StormFile& first = *known_[paths.front()].description;
  file.version = ++versions_;
  file.id = first.id;
  file.device = first.device;
}

bool CatalogueScan::Look(const Stamp& stamp, Known& known) {
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
    known.unchanged_since = now_;
    // A file that the first scan finds may be old enough to count as complete at once. For all
    // other files the settling time starts now, so that new files of one folder become complete
    // together. If one of them were complete first, it would become a storm with a different name.
    known.settled =
        fresh && scans_ == 1 &&
        now_ - base::UnchangedSince(stamp.changed_ns, Time::min(), now_) >= options_.settle;
    known.tried_at.reset();
    known.tries = 0;
    known.trial = Trial::kBatch;
  }
  if (!known.settled && now_ - known.unchanged_since < options_.settle) {
    LookAgainAt(known.unchanged_since + options_.settle);
    return false;
  }
  known.settled = true;
  return MustOpen(known);
}

bool CatalogueScan::MustOpen(const Known& known) const {
  if (!known.tried_at.has_value()) return true;
  if (known.complaint.empty()) return false;
  // There may be very many files that are no storms, so each is tried less and less often.
  constexpr int kMostDoublings = 5;
  constexpr std::chrono::minutes kSlowRetry{10};
  const int doublings = std::clamp(known.tries - 1, 0, kMostDoublings);
  const Time::duration first = known.trial == Trial::kPatient
                                   ? std::max<Time::duration>(options_.retry, kSlowRetry)
                                   : options_.retry;
  return now_ - *known.tried_at >= first * (1 << doublings);
}

void CatalogueScan::Take(const std::string& path, absl::StatusOr<storm_files::StormFile> file,
                         Known& known) {
  known.tried_at = now_;
  // If the stamp has changed, the file was written while it was read, and its description is out of
  // date.
  if (StampOf(path) != known.stamp) {
    known.tried_at.reset();
    known.settled = false;
    known.unchanged_since = now_;
    return LookAgainAt(now_ + options_.settle);
  }
  if (file.ok()) {
    const bool goes_on =
        known.description.has_value() && !known.replaces && GoesOn(*known.description, *file);
    file->version = goes_on ? known.description->version : ++versions_;
    file->id = known.stamp.file;
    known.description = *std::move(file);
    known.replaces = false;
    known.complaint.clear();
    known.tries = 0;
    changed_ = true;
    return;
  }
  if (std::exchange(known.replaces, false)) Lose(known);
  ++known.tries;
  const std::string complaint(file.status().message());
  if (complaint == known.complaint) return;
  known.complaint = complaint;
  // A file of another kind, such as a read-me, is normal and needs no warning.
  left_out_.Add(complaint, !absl::IsInvalidArgument(file.status()), now_);
}

void CatalogueScan::Lose(Known& known) {
  changed_ = changed_ || known.description.has_value();
  known.description.reset();
}

void CatalogueScan::LookAgainAt(Time time) {
  look_again_at_ = std::min(look_again_at_.value_or(time), time);
}

}  // namespace thunderhead::storm_store
