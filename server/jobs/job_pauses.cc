// The part of JobBoard that handles unfetched results and expiry. It decides when unfetched results
// pause drawing, and when jobs are ended or forgotten.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "jobs/job_board.h"

namespace thunderhead::jobs {

JobBoard::Unfetched JobBoard::UnfetchedBytes() const {
  Unfetched unfetched;
  for (const auto& [id, entry] : jobs_) {
    unfetched.all += entry.unfetched_bytes;
    unfetched.by_owner[entry.record.owner] += entry.unfetched_bytes;
  }
  return unfetched;
}

std::optional<Problem> JobBoard::PausedBecause(const std::string& owner,
                                               const Unfetched& unfetched) const {
  const auto own = unfetched.by_owner.find(owner);
  const std::uint64_t own_bytes = own == unfetched.by_owner.end() ? 0 : own->second;
  const auto because = [](const char* whose, std::uint64_t bytes, std::uint64_t maximum,
                          const char* flag) {
    return Problem{
        absl::StatusCode::kResourceExhausted, "RESULTS_NOT_FETCHED",
        absl::StrCat("no further picture is begun: the unfetched results ", whose, " take ", bytes,
                     " bytes of ", maximum, " (", flag, "); fetch some, or forget jobs")};
  };
  if (own_bytes >= limits_.max_result_bytes_per_owner) {
    return because("of your jobs", own_bytes, limits_.max_result_bytes_per_owner,
                   "--jobs-quota-each");
  }
  if (unfetched.all >= limits_.max_result_bytes) {
    return because("of all jobs", unfetched.all, limits_.max_result_bytes, "--jobs-quota");
  }
  return std::nullopt;
}

std::optional<Problem> JobBoard::UnwritableBecause(const Entry& entry) const {
  if (Unended(entry) == 0) return std::nullopt;
  return entry.unwritable.has_value() ? entry.unwritable : all_unwritable_;
}

std::optional<Problem> JobBoard::PauseOf(const Entry& entry, const Unfetched& unfetched) const {
  std::optional<Problem> unwritable = UnwritableBecause(entry);
  if (unwritable.has_value() || entry.counts[IndexOf(PictureState::kWaiting)] == 0) {
    return unwritable;
  }
  return PausedBecause(entry.record.owner, unfetched);
}

void JobBoard::SetUnwritable(const std::string& id, std::optional<Problem> why) {
  const auto job = jobs_.find(id);
  if (job != jobs_.end()) job->second.unwritable = std::move(why);
}

void JobBoard::SetAllUnwritable(std::optional<Problem> why) { all_unwritable_ = std::move(why); }

std::vector<std::string> JobBoard::TakePauses() {
  std::vector<std::string> changed;
  const Unfetched unfetched = UnfetchedBytes();
  for (auto& [id, entry] : jobs_) {
    const bool waits = entry.counts[IndexOf(PictureState::kWaiting)] > 0;
    const bool is_paused = PauseOf(entry, unfetched).has_value();
    // A change of a job without waiting pictures is not reported, because watchers were already
    // notified when its last picture ended.
    const bool is_told = waits || is_paused;
    if (std::exchange(entry.was_paused, is_paused) == is_paused || !is_told) continue;
    ++entry.version;
    changed.push_back(id);
  }
  return changed;
}

std::size_t JobBoard::Paused() const {
  const Unfetched unfetched = UnfetchedBytes();
  std::size_t paused = 0;
  for (const auto& [id, entry] : jobs_) {
    const std::size_t waiting = entry.counts[IndexOf(PictureState::kWaiting)];
    if (waiting > 0 && PausedBecause(entry.record.owner, unfetched).has_value()) paused += waiting;
  }
  return paused;
}

std::optional<Time> JobBoard::AbandonedAt(const Entry& entry, const Unfetched& unfetched) const {
  if (entry.record.ended_at.has_value() || entry.unfetched == 0) return std::nullopt;
  if (entry.counts[IndexOf(PictureState::kWaiting)] == 0) return std::nullopt;
  // A job is not abandoned while its pictures are being drawn.
  if (entry.counts[IndexOf(PictureState::kDrawing)] > 0) return std::nullopt;
  if (!PausedBecause(entry.record.owner, unfetched).has_value()) return std::nullopt;
  return entry.last_used + limits_.keep;
}

void JobBoard::EndAbandoned(Entry& entry, Time now, Expired& expired) {
  const Problem problem{
      absl::StatusCode::kResourceExhausted, "RESULTS_NOT_FETCHED",
      absl::StrCat("the results of this job were not fetched for ", limits_.keep.count(),
                   " s (--jobs-keep), so its other pictures could not be drawn")};
  for (std::size_t i = 0; i < entry.record.pictures.size(); ++i) {
    ImageRecord& picture = entry.record.pictures[i];
    if (picture.state == PictureState::kWaiting) {
      picture.problem = problem;
      SetState(entry, i, PictureState::kFailed);
      ++expired.failed;
    } else if (picture.state == PictureState::kDrawn && !picture.fetched) {
      expired.dropped.push_back(
          {{entry.record.id, i}, picture.extension, picture.sha256, picture.bytes});
      picture.problem = problem;
      SetState(entry, i, PictureState::kDropped);
    }
  }
  EndIfDone(entry, now);
}

JobBoard::Expired JobBoard::Expire(Time now) {
  for (auto job = jobs_.begin(); job != jobs_.end();) {
    const auto here = job++;
    const std::optional<Time>& ended_at = here->second.record.ended_at;
    if (ended_at.has_value() && *ended_at + limits_.keep <= now) Erase(here);
  }
  Expired expired;
  // Ends the jobs one by one, the oldest first, because dropping the results of one job may allow
  // the other jobs to continue.
  while (true) {
    const Unfetched unfetched = UnfetchedBytes();
    std::optional<Time> first;
    Entry* abandoned = nullptr;
    for (auto& [id, entry] : jobs_) {
      const std::optional<Time> at = AbandonedAt(entry, unfetched);
      if (!at.has_value() || *at > now || (first.has_value() && *first <= *at)) continue;
      first = at;
      abandoned = &entry;
    }
    if (abandoned == nullptr) return expired;
    EndAbandoned(*abandoned, now, expired);
  }
}

std::optional<Time> JobBoard::NextExpiry() const {
  std::optional<Time> next;
  const Unfetched unfetched = UnfetchedBytes();
  for (const auto& [id, entry] : jobs_) {
    const std::optional<Time>& ended_at = entry.record.ended_at;
    const std::optional<Time> at = ended_at.has_value() ? std::optional(*ended_at + limits_.keep)
                                                        : AbandonedAt(entry, unfetched);
    if (!at.has_value()) continue;
    if (!next.has_value() || *at < *next) next = at;
  }
  return next;
}

}  // namespace thunderhead::jobs
