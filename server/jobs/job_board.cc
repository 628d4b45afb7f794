#include "jobs/job_board.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::jobs {
namespace {

absl::Status NotFound(const std::string& id) {
  return base::WithDetails(
      absl::NotFoundError(absl::StrCat("no render job has the id '", id,
                                       "'; jobs that have ended are forgotten after a time")),
      {.reason = "JOB_NOT_FOUND", .metadata = {{"job_id", id}}});
}

}  // namespace

JobBoard::Entry& JobBoard::Insert(JobRecord record) {
  const std::string id = record.id;
  id_by_key_[record.result_key] = id;
  Entry& entry = jobs_[id];
  entry.record = std::move(record);
  entry.order = ++created_;
  entry.version = 1;
  entry.versions.assign(entry.record.pictures.size(), 1);
  entry.not_before.assign(entry.record.pictures.size(), Time::min());
  for (const ImageRecord& picture : entry.record.pictures) {
    ++entry.counts[IndexOf(picture.state)];
    if (picture.state == PictureState::kDrawn) AddResult(entry, picture);
  }
  return entry;
}

void JobBoard::AddResult(Entry& entry, const ImageRecord& picture) {
  entry.last_used = std::max(entry.last_used, picture.drawn_at);
  entry.result_bytes += picture.bytes;
  result_bytes_ += picture.bytes;
  if (picture.fetched) return;
  entry.unfetched_bytes += picture.bytes;
  ++entry.unfetched;
}

void JobBoard::RemoveResult(Entry& entry, const ImageRecord& picture) {
  entry.result_bytes -= picture.bytes;
  result_bytes_ -= picture.bytes;
  if (picture.fetched) return;
  entry.unfetched_bytes -= picture.bytes;
  --entry.unfetched;
}

void JobBoard::Restore(JobRecord record, Time now) {
  Entry& entry = Insert(std::move(record));
  entry.saved = true;
  EndIfDone(entry, now);
}

std::size_t JobBoard::Unended(const Entry& entry) const {
  return entry.counts[IndexOf(PictureState::kWaiting)] +
         entry.counts[IndexOf(PictureState::kDrawing)];
}

absl::Status JobBoard::Add(const std::string& id, const std::string& result_key, NewJob job,
                           Time now) {
  if (absl::Status full = CheckPictures(job); !full.ok()) return full;
  if (absl::Status full = MakeRoomForJob(job); !full.ok()) return full;
  JobRecord record;
  record.id = id;
  record.result_key = result_key;
  record.owner = std::move(job.owner);
  record.label = std::move(job.label);
  record.created_at = now;
  record.pictures.reserve(job.pictures.size());
  for (PictureOrder& order : job.pictures) {
    record.pictures.emplace_back().order = std::move(order);
  }
  Insert(std::move(record));
  return absl::OkStatus();
}

void JobBoard::SetSaved(const std::string& id) {
  const auto job = jobs_.find(id);
  if (job != jobs_.end()) job->second.saved = true;
}

absl::Status JobBoard::Check(const std::string& id, const Asker& asker) const {
  const auto job = jobs_.find(id);
  if (job == jobs_.end()) return NotFound(id);
  if (asker.is_operator || job->second.record.owner == asker.name) return absl::OkStatus();
  return base::WithDetails(
      absl::PermissionDeniedError("this render job belongs to another identity; only its owner or "
                                  "an operator may see or end it"),
      {.reason = "NOT_YOUR_JOB"});
}

JobView JobBoard::ViewOf(const Entry& entry, const Unfetched& unfetched) const {
  JobView view;
  view.id = entry.record.id;
  view.result_key = entry.record.result_key;
  view.owner = entry.record.owner;
  view.label = entry.record.label;
  view.created_at = entry.record.created_at;
  view.ended_at = entry.record.ended_at;
  if (view.ended_at.has_value()) view.expires_at = *view.ended_at + limits_.keep;
  view.cancelled = entry.record.cancelled;
  view.counts = entry.counts;
  view.result_bytes = entry.result_bytes;
  view.paused = PauseOf(entry, unfetched);
  return view;
}

std::optional<JobNews> JobBoard::NewsOf(const std::string& id, std::uint64_t version) const {
  const auto job = jobs_.find(id);
  if (job == jobs_.end()) return std::nullopt;
  const Entry& entry = job->second;
  JobNews news{ViewOf(entry, UnfetchedBytes()), {}, entry.version};
  for (std::size_t i = 0; i < entry.versions.size(); ++i) {
    if (entry.versions[i] <= version) continue;
    const ImageRecord& picture = entry.record.pictures[i];
    news.pictures.push_back({i, picture.order.name, picture.state, picture.problem, picture.bytes,
                             picture.sha256, picture.milliseconds});
  }
  return news;
}

std::vector<JobView> JobBoard::All() const {
  std::vector<std::pair<std::uint64_t, const Entry*>> ordered;
  ordered.reserve(jobs_.size());
  for (const auto& [id, entry] : jobs_) ordered.emplace_back(entry.order, &entry);
  std::ranges::sort(ordered);
  std::vector<JobView> views;
  views.reserve(ordered.size());
  const Unfetched unfetched = UnfetchedBytes();
  for (const auto& [order, entry] : ordered) views.push_back(ViewOf(*entry, unfetched));
  return views;
}

absl::StatusOr<ResultFile> JobBoard::ResultOf(const PicturePlace& picture) const {
  const auto job = jobs_.find(picture.job_id);
  if (job == jobs_.end()) return NotFound(picture.job_id);
  const std::vector<ImageRecord>& pictures = job->second.record.pictures;
  if (picture.place >= pictures.size()) {
    return base::InvalidField(
        "index",
        absl::StrCat("is ", picture.place, "; the job has pictures 0 to ", pictures.size() - 1),
        "VALUE_OUT_OF_RANGE", {{"minimum", "0"}, {"maximum", absl::StrCat(pictures.size() - 1)}});
  }
  const ImageRecord& record = pictures[picture.place];
  switch (record.state) {
    case PictureState::kDrawn:
      return ResultFile{picture, record.extension, record.sha256, record.bytes};
    case PictureState::kWaiting:
    case PictureState::kDrawing:
      return base::WithDetails(
          absl::FailedPreconditionError("this picture is not drawn yet; watch the job"),
          {.reason = "PICTURE_NOT_DRAWN"});
    case PictureState::kFailed:
    case PictureState::kCancelled:
    case PictureState::kDropped:
      break;
  }
  return base::WithDetails(
      absl::NotFoundError(absl::StrCat("this picture has no result: ",
                                       record.problem.message.empty()
                                           ? "it was cancelled; request it in a new job"
                                           : record.problem.message)),
      {.reason = "NO_SUCH_RESULT"});
}

std::string JobBoard::IdOfKey(const std::string& result_key) const {
  const auto id = id_by_key_.find(result_key);
  return id == id_by_key_.end() ? "" : id->second;
}

std::optional<std::size_t> JobBoard::Waiting(Entry& entry, Time now) const {
  const std::vector<ImageRecord>& pictures = entry.record.pictures;
  std::size_t& first = entry.first_waiting;
  while (first < pictures.size() && pictures[first].state != PictureState::kWaiting) ++first;
  for (std::size_t i = first; i < pictures.size(); ++i) {
    if (pictures[i].state == PictureState::kWaiting && entry.not_before[i] <= now) return i;
  }
  return std::nullopt;
}

std::optional<PicturePlace> JobBoard::Begin(Time now) {
  std::map<std::string, std::vector<std::string>> waiting;  // ids of jobs with waiting pictures, by
                                                            // owner
  std::map<std::string, std::size_t> places;
  std::vector<std::pair<std::uint64_t, Entry*>> ordered;
  const Unfetched unfetched = UnfetchedBytes();
  for (auto& [id, entry] : jobs_) {
    if (entry.saved && entry.counts[IndexOf(PictureState::kWaiting)] > 0 &&
        !PausedBecause(entry.record.owner, unfetched).has_value()) {
      ordered.emplace_back(entry.order, &entry);
    }
  }
  std::ranges::sort(ordered);
  std::vector<std::string> owners;
  for (const auto& [order, entry] : ordered) {
    const std::optional<std::size_t> place = Waiting(*entry, now);
    if (!place.has_value()) continue;
    const std::string& owner = entry->record.owner;
    if (waiting[owner].empty()) owners.push_back(owner);
    waiting[owner].push_back(entry->record.id);
    places[entry->record.id] = *place;
  }
  std::erase_if(shares_, [&](const auto& share) { return !waiting.contains(share.first); });
  if (owners.empty()) return std::nullopt;
  const std::string owner = owners_.Next(owners);
  const std::string id = shares_[owner].Next(waiting[owner]);
  // The duration of an earlier picture is charged as an estimate, until the picture's own duration
  // is known.
  owners_.Charge(owner, typical_ms_);
  shares_[owner].Charge(id, typical_ms_);
  PicturePlace picture{id, places[id]};
  charges_[picture] = {owner, typical_ms_};
  Entry& entry = jobs_.at(id);
  ++entry.record.pictures[picture.place].attempts;
  SetState(entry, picture.place, PictureState::kDrawing);
  return picture;
}

const PictureOrder& JobBoard::OrderOf(const PicturePlace& picture) const {
  return jobs_.at(picture.job_id).record.pictures[picture.place].order;
}

std::optional<Time> JobBoard::NextRetry(Time now) const {
  std::optional<Time> next;
  for (const auto& [id, entry] : jobs_) {
    for (std::size_t i = entry.first_waiting; i < entry.not_before.size(); ++i) {
      if (entry.record.pictures[i].state != PictureState::kWaiting) continue;
      if (entry.not_before[i] <= now) continue;
      if (!next.has_value() || entry.not_before[i] < *next) next = entry.not_before[i];
    }
  }
  return next;
}

void JobBoard::SetState(Entry& entry, std::size_t place, PictureState state) {
  ImageRecord& picture = entry.record.pictures[place];
  const bool was_drawn = picture.state == PictureState::kDrawn;
  const bool is_drawn = state == PictureState::kDrawn;
  if (was_drawn != is_drawn) {
    if (is_drawn) {
      AddResult(entry, picture);
    } else {
      RemoveResult(entry, picture);
    }
  }
  --entry.counts[IndexOf(picture.state)];
  ++entry.counts[IndexOf(state)];
  picture.state = state;
  entry.versions[place] = ++entry.version;
  if (state == PictureState::kWaiting) entry.first_waiting = std::min(entry.first_waiting, place);
  unsaved_.insert({entry.record.id, place});
}

void JobBoard::EndIfDone(Entry& entry, Time now) {
  if (entry.record.ended_at.has_value() || Unended(entry) > 0) return;
  entry.record.ended_at = now;
  ++entry.version;
  unsaved_jobs_.insert(entry.record.id);
  // The pictures of an ended job are not drawn again, so their requests are deleted.
  for (ImageRecord& picture : entry.record.pictures) picture.order.request = {};
}

ImageRecord* JobBoard::Drawing(const PicturePlace& picture, Entry** entry) {
  const auto job = jobs_.find(picture.job_id);
  if (job == jobs_.end()) return nullptr;
  ImageRecord& record = job->second.record.pictures[picture.place];
  if (record.state != PictureState::kDrawing) return nullptr;
  *entry = &job->second;
  return &record;
}

bool JobBoard::IsDrawing(const PicturePlace& picture) const {
  const auto job = jobs_.find(picture.job_id);
  return job != jobs_.end() &&
         job->second.record.pictures[picture.place].state == PictureState::kDrawing;
}

int JobBoard::Attempts(const PicturePlace& picture) const {
  const auto job = jobs_.find(picture.job_id);
  return job == jobs_.end() ? kMaxAttempts + 1
                            : job->second.record.pictures[picture.place].attempts;
}

void JobBoard::Settle(const PicturePlace& picture, std::optional<double> draw_ms) {
  const auto found = charges_.extract(picture);
  if (found.empty()) return;
  const auto& [owner, expected_ms] = found.mapped();
  const double used_ms = draw_ms.value_or(expected_ms);
  owners_.Settle(owner, expected_ms, used_ms);
  const auto share = shares_.find(owner);
  if (share != shares_.end()) share->second.Settle(picture.job_id, expected_ms, used_ms);
}

bool JobBoard::Drawn(const PicturePlace& picture, const ResultFile& file, double milliseconds,
                     double draw_ms, Time now) {
  Settle(picture, draw_ms);
  Entry* entry = nullptr;
  ImageRecord* record = Drawing(picture, &entry);
  if (record == nullptr) return false;
  typical_ms_ = draw_ms;
  record->bytes = file.bytes;
  record->sha256 = file.sha256;
  record->extension = file.extension;
  record->milliseconds = milliseconds;
  record->drawn_at = now;
  record->fetched = false;
  SetState(*entry, picture.place, PictureState::kDrawn);
  EndIfDone(*entry, now);
  return true;
}

bool JobBoard::Fail(const PicturePlace& picture, const Problem& problem, Time now) {
  Settle(picture, std::nullopt);
  Entry* entry = nullptr;
  ImageRecord* record = Drawing(picture, &entry);
  if (record == nullptr) return false;
  record->problem = problem;
  SetState(*entry, picture.place, PictureState::kFailed);
  EndIfDone(*entry, now);
  return true;
}

bool JobBoard::PutBack(const PicturePlace& picture, bool counts, Time not_before) {
  Settle(picture, std::nullopt);
  Entry* entry = nullptr;
  ImageRecord* record = Drawing(picture, &entry);
  if (record == nullptr) return false;
  if (!counts) --record->attempts;
  entry->not_before[picture.place] = not_before;
  SetState(*entry, picture.place, PictureState::kWaiting);
  return true;
}

void JobBoard::Fetched(const PicturePlace& picture, Time now) {
  const auto job = jobs_.find(picture.job_id);
  if (job == jobs_.end() || picture.place >= job->second.record.pictures.size()) return;
  ImageRecord& record = job->second.record.pictures[picture.place];
  if (record.fetched || record.state != PictureState::kDrawn) return;
  record.fetched = true;
  job->second.last_used = std::max(job->second.last_used, now);
  job->second.unfetched_bytes -= record.bytes;
  --job->second.unfetched;
  unsaved_.insert(picture);
}

void JobBoard::Cancel(const std::string& id, Time now) {
  const auto job = jobs_.find(id);
  if (job == jobs_.end() || job->second.record.ended_at.has_value()) return;
  Entry& entry = job->second;
  for (std::size_t i = 0; i < entry.record.pictures.size(); ++i) {
    const PictureState state = entry.record.pictures[i].state;
    if (state == PictureState::kWaiting || state == PictureState::kDrawing) {
      SetState(entry, i, PictureState::kCancelled);
    }
  }
  entry.record.cancelled = true;
  EndIfDone(entry, now);
}

void JobBoard::Erase(Jobs::iterator job) {
  const std::string id = job->first;
  result_bytes_ -= job->second.result_bytes;
  id_by_key_.erase(job->second.record.result_key);
  std::erase_if(unsaved_, [&](const PicturePlace& picture) { return picture.job_id == id; });
  unsaved_jobs_.erase(id);
  forgotten_.push_back(id);
  jobs_.erase(job);
}

void JobBoard::Forget(const std::string& id) {
  if (const auto job = jobs_.find(id); job != jobs_.end()) Erase(job);
}

std::vector<JobChange> JobBoard::TakeChanges() {
  std::map<std::string, JobChange> by_id;
  for (const PicturePlace& picture : std::exchange(unsaved_, {})) {
    JobChange::Picture change{picture.place,
                              jobs_.at(picture.job_id).record.pictures[picture.place]};
    change.record.order = {};
    by_id[picture.job_id].pictures.push_back(std::move(change));
  }
  for (const std::string& id : std::exchange(unsaved_jobs_, {})) by_id[id];
  std::vector<JobChange> changes;
  changes.reserve(by_id.size());
  for (auto& [id, change] : by_id) {
    const JobRecord& record = jobs_.at(id).record;
    change.id = id;
    change.ended_at = record.ended_at;
    change.cancelled = record.cancelled;
    changes.push_back(std::move(change));
  }
  return changes;
}

void JobBoard::GiveBack(const std::vector<JobChange>& changes) {
  for (const JobChange& change : changes) {
    if (!jobs_.contains(change.id)) continue;
    unsaved_jobs_.insert(change.id);
    for (const JobChange::Picture& picture : change.pictures) {
      unsaved_.insert({change.id, picture.place});
    }
  }
}

void JobBoard::GiveBackForgotten(const std::vector<std::string>& ids) {
  forgotten_.insert(forgotten_.end(), ids.begin(), ids.end());
}

PictureCounts JobBoard::Counts() const {
  PictureCounts counts{};
  for (const auto& [id, entry] : jobs_) {
    for (std::size_t i = 0; i < kPictureStates; ++i) counts[i] += entry.counts[i];
  }
  return counts;
}

std::size_t JobBoard::Running() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      jobs_, [](const auto& job) { return !job.second.record.ended_at.has_value(); }));
}

std::set<std::string> JobBoard::Ids() const {
  std::set<std::string> ids;
  for (const auto& [id, entry] : jobs_) ids.insert(id);
  return ids;
}

}  // namespace thunderhead::jobs
