// The part of JobBoard that limits the numbers of jobs and pictures. It also decides which ended
// jobs are forgotten to accept new jobs.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "jobs/job_board.h"

namespace thunderhead::jobs {
namespace {

// The retry delay when a quota is exhausted. In this time a few pictures are drawn, so jobs may
// have ended.
constexpr std::chrono::seconds kRetryAfter{30};

absl::Status TooMany(const std::string& what, std::size_t maximum, const char* unit,
                     const char* reason) {
  return base::WithDetails(absl::ResourceExhaustedError(absl::StrCat(
                               what, ", and this server allows ", maximum,
                               "; try again when jobs have ended and their results were fetched")),
                           {.reason = reason,
                            .metadata = {{"maximum", absl::StrCat(maximum)}, {"unit", unit}},
                            .retry_after = kRetryAfter});
}

}  // namespace

absl::Status JobBoard::CheckPictures(const NewJob& job) const {
  std::size_t all = job.pictures.size();
  std::size_t own = job.pictures.size();
  for (const auto& [id, entry] : jobs_) {
    all += Unended(entry);
    if (entry.record.owner == job.owner) own += Unended(entry);
  }
  if (own > limits_.max_pictures_per_owner) {
    return TooMany(absl::StrCat("with this job ", own, " of your pictures would wait to be drawn"),
                   limits_.max_pictures_per_owner, "pictures", "TOO_MANY_JOB_PICTURES");
  }
  if (all > limits_.max_pictures) {
    return TooMany(absl::StrCat("with this job ", all, " pictures would wait to be drawn"),
                   limits_.max_pictures, "pictures", "TOO_MANY_JOB_PICTURES");
  }
  return absl::OkStatus();
}

std::pair<std::size_t, std::size_t> JobBoard::Kept(const std::string* owner) const {
  std::size_t jobs = 0;
  std::size_t pictures = 0;
  for (const auto& [id, entry] : jobs_) {
    if (owner != nullptr && entry.record.owner != *owner) continue;
    ++jobs;
    pictures += entry.record.pictures.size();
  }
  return {jobs, pictures};
}

std::vector<JobBoard::Jobs::iterator> JobBoard::Forgettable(const std::string& first_of) {
  std::vector<Jobs::iterator> jobs;
  for (auto job = jobs_.begin(); job != jobs_.end(); ++job) {
    if (job->second.record.ended_at.has_value() && job->second.unfetched == 0) jobs.push_back(job);
  }
  std::ranges::stable_sort(jobs, {}, [&](const Jobs::iterator& job) {
    return std::pair(job->second.record.owner != first_of, *job->second.record.ended_at);
  });
  return jobs;
}

absl::Status JobBoard::MakeRoomForJob(const NewJob& job) {
  struct Share {
    const std::string* owner;  // null for all owners
    const char* who;
    std::size_t max_jobs;
    std::size_t max_pictures;
  };
  std::vector<Jobs::iterator> candidates = Forgettable(job.owner);
  std::vector<Jobs::iterator> to_forget;
  for (const Share& share :
       {Share{&job.owner, "you have", limits_.max_jobs_per_owner,
              limits_.max_kept_pictures_per_owner},
        Share{nullptr, "the server has", limits_.max_jobs, limits_.max_kept_pictures}}) {
    auto [jobs, pictures] = Kept(share.owner);
    const auto forget = [&jobs = jobs, &pictures = pictures](const Jobs::iterator& one) {
      --jobs;
      pictures -= one->second.record.pictures.size();
    };
    std::ranges::for_each(to_forget, forget);
    while (jobs >= share.max_jobs || pictures + job.pictures.size() > share.max_pictures) {
      const bool helps =
          !candidates.empty() &&
          (share.owner == nullptr || candidates.front()->second.record.owner == *share.owner);
      if (helps) {
        forget(candidates.front());
        to_forget.push_back(candidates.front());
        candidates.erase(candidates.begin());
        continue;
      }
      if (jobs >= share.max_jobs) {
        return TooMany(absl::StrCat(share.who, " ", jobs, " render jobs"), share.max_jobs, "jobs",
                       "TOO_MANY_JOBS");
      }
      return TooMany(absl::StrCat(share.who, " ", pictures, " pictures in render jobs, and with ",
                                  "this job ", pictures + job.pictures.size()),
                     share.max_pictures, "pictures", "TOO_MANY_JOB_PICTURES");
    }
  }
  // Jobs are forgotten only if this makes enough room for the new job.
  for (const Jobs::iterator& one : to_forget) Erase(one);
  return absl::OkStatus();
}

std::vector<ResultFile> JobBoard::MakeRoom() {
  std::vector<ResultFile> dropped;
  if (result_bytes_ <= limits_.max_result_bytes) return dropped;
  // Sorts results of running jobs last and older ones first.
  std::vector<std::tuple<bool, Time, PicturePlace>> order;
  for (const auto& [id, entry] : jobs_) {
    for (std::size_t i = 0; i < entry.record.pictures.size(); ++i) {
      const ImageRecord& picture = entry.record.pictures[i];
      if (picture.state != PictureState::kDrawn || !picture.fetched) continue;
      order.emplace_back(!entry.record.ended_at.has_value(), picture.drawn_at, PicturePlace{id, i});
    }
  }
  std::ranges::sort(order);
  for (const auto& candidate : order) {
    if (result_bytes_ <= limits_.max_result_bytes) break;
    const PicturePlace& picture = std::get<PicturePlace>(candidate);
    Entry& entry = jobs_.at(picture.job_id);
    ImageRecord& record = entry.record.pictures[picture.place];
    dropped.push_back({picture, record.extension, record.sha256, record.bytes});
    record.problem = {
        absl::StatusCode::kNotFound, "RESULT_DROPPED",
        absl::StrCat(
            "it was fetched, and then deleted to free space: the results of all jobs may take ",
            limits_.max_result_bytes, " bytes (--jobs-quota)")};
    SetState(entry, picture.place, PictureState::kDropped);
  }
  return dropped;
}

}  // namespace thunderhead::jobs
