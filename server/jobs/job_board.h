// The state of all render jobs. It decides which picture is drawn next and which results are
// evicted. It is a plain value: the caller passes the current time, and the class uses no threads,
// files or clocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/fair_share.h"
#include "jobs/job_limits.h"
#include "jobs/job_record.h"
#include "jobs/job_store.h"

namespace thunderhead::jobs {

struct NewJob {
  std::string owner;
  std::string label;
  std::vector<PictureOrder> pictures;
};

// The identity that makes a request about a job.
struct Asker {
  std::string name;
  bool is_operator = false;  // true if the identity may access the jobs of all owners
};

using PictureCounts = std::array<std::size_t, kPictureStates>;
inline std::size_t IndexOf(PictureState state) { return static_cast<std::size_t>(state); }

// The state of a job, without the state of each picture.
struct JobView {
  std::string id;
  std::string result_key;
  std::string owner;
  std::string label;
  Time created_at;
  std::optional<Time> ended_at;
  std::optional<Time> expires_at;
  bool cancelled = false;
  PictureCounts counts{};
  std::uint64_t result_bytes = 0;
  // Set if no further picture may be begun until clients have fetched results, or if the job's
  // results cannot be written.
  std::optional<Problem> paused;
};

struct PictureView {
  std::size_t place = 0;
  std::string name;
  PictureState state = PictureState::kWaiting;
  Problem problem;
  std::uint64_t bytes = 0;
  std::string sha256;
  double milliseconds = 0.0;
};

// The changes of a job since a given version: the job's state and the pictures that changed.
struct JobNews {
  JobView job;
  std::vector<PictureView> pictures;
  std::uint64_t version = 0;
};

// Identifies a picture by its job and its index (place) in the job.
struct PicturePlace {
  std::string job_id;
  std::size_t place = 0;

  auto operator<=>(const PicturePlace&) const = default;
};

// The file of a drawn picture.
struct ResultFile {
  PicturePlace picture;
  std::string extension;
  std::string sha256;
  std::uint64_t bytes = 0;
};

class JobBoard {
 public:
  // A picture that was begun this many times and neither drawn nor failed is not begun again.
  static constexpr int kMaxAttempts = 5;

  explicit JobBoard(const JobLimits& limits) : limits_(limits) {}

  // Adds a job that was loaded from a store.
  void Restore(JobRecord record, Time now);

  // Adds a job with the id `id`. If there are too many jobs, forgets ended jobs, those of the same
  // owner first. Jobs with unfetched results are not forgotten. If this does not suffice, or too
  // many pictures would wait to be drawn, returns RESOURCE_EXHAUSTED and forgets no job.
  absl::Status Add(const std::string& id, const std::string& result_key, NewJob job, Time now);
  // Returns the job's record, which the caller stores. The job must exist.
  const JobRecord& Record(const std::string& id) const { return jobs_.at(id).record; }
  // Records that the job is saved, so that its pictures may be begun. Does nothing if the job does
  // not exist.
  void SetSaved(const std::string& id);

  // Returns NOT_FOUND if the job does not exist, and PERMISSION_DENIED if `asker` may not access
  // it.
  absl::Status Check(const std::string& id, const Asker& asker) const;
  // Returns the changes of a job after `version`, or its whole state for version 0. Returns nothing
  // if the job does not exist.
  std::optional<JobNews> NewsOf(const std::string& id, std::uint64_t version) const;
  // Returns all jobs in the order of their creation.
  std::vector<JobView> All() const;
  // Returns the result file of a picture. Returns NOT_FOUND if the job does not exist or the
  // picture has no file. Returns FAILED_PRECONDITION if the picture is not drawn yet, and
  // INVALID_ARGUMENT if the job has no picture with that index.
  absl::StatusOr<ResultFile> ResultOf(const PicturePlace& picture) const;
  // Returns the id of the job with that result key, or an empty text if there is no such job.
  std::string IdOfKey(const std::string& result_key) const;

  // Marks the next picture as being drawn and returns it. Returns nothing if no picture may be
  // begun now, for example because unfetched results use up the quota.
  std::optional<PicturePlace> Begin(Time now);
  const PictureOrder& OrderOf(const PicturePlace& picture) const;
  // Returns the earliest time after `now` at which a picture that was put back may be begun again,
  // or nothing if there is no such picture.
  std::optional<Time> NextRetry(Time now) const;

  // Drawn and Fail record that a picture was drawn or has failed. They return false if the picture
  // is no longer being drawn, because its job was cancelled.
  bool Drawn(const PicturePlace& picture, const ResultFile& file, double milliseconds,
             double draw_ms, Time now);
  bool Fail(const PicturePlace& picture, const Problem& problem, Time now);
  // Marks the picture as waiting again, to be begun at `not_before` or later. `counts` says whether
  // the ended attempt counts towards kMaxAttempts. Returns false in the same case as Drawn.
  bool PutBack(const PicturePlace& picture, bool counts, Time not_before);
  // Records why the job's results cannot be written, or nothing if they can. Does nothing if the
  // job does not exist.
  void SetUnwritable(const std::string& id, std::optional<Problem> why);
  // Records why no job's results can be written, or nothing.
  void SetAllUnwritable(std::optional<Problem> why);
  bool IsDrawing(const PicturePlace& picture) const;
  // Returns false if the picture has been begun more than kMaxAttempts times, including the attempt
  // that Begin has just counted.
  bool MayBegin(const PicturePlace& picture) const { return Attempts(picture) <= kMaxAttempts; }
  // Returns how often the picture was begun, without attempts that do not count. If the picture no
  // longer exists, the result is larger than kMaxAttempts.
  int Attempts(const PicturePlace& picture) const;

  void Fetched(const PicturePlace& picture, Time now);
  // Cancels the job's pictures that have not ended.
  void Cancel(const std::string& id, Time now);
  void Forget(const std::string& id);
  // The outcome of Expire. The caller must remove the files in `dropped`.
  struct Expired {
    std::vector<ResultFile> dropped;
    std::size_t failed = 0;  // pictures that will not be drawn
  };
  // Forgets jobs that ended longer ago than JobLimits::keep. Also ends jobs that are paused because
  // their results were not fetched for that time, and drops their results. Otherwise such jobs
  // could pause the drawing of all jobs indefinitely.
  Expired Expire(Time now);
  // Returns the time at which Expire will next have work to do, or nothing if no job expires.
  std::optional<Time> NextExpiry() const;
  // Returns the ids of the jobs whose drawing was paused or resumed since the last call, so that
  // their watchers can be notified.
  std::vector<std::string> TakePauses();
  // Drops fetched results while all results together exceed their limit, and returns the dropped
  // results. Results of ended jobs are dropped first, and older results before newer results.
  std::vector<ResultFile> MakeRoom();

  // Returns the changes that are not saved yet, and marks them as saved.
  std::vector<JobChange> TakeChanges();
  // Marks changes as unsaved again, because they could not be saved.
  void GiveBack(const std::vector<JobChange>& changes);
  // Returns the ids of the jobs that were forgotten since the last call. The caller must remove
  // them from the store.
  std::vector<std::string> TakeForgotten() { return std::exchange(forgotten_, {}); }
  // Adds ids to the result of the next TakeForgotten, because the store could not remove the jobs.
  void GiveBackForgotten(const std::vector<std::string>& ids);

  // Returns the number of pictures in each state, over all jobs.
  PictureCounts Counts() const;
  std::size_t Running() const;
  // Returns the number of waiting pictures that may not be begun because results must be fetched
  // first.
  std::size_t Paused() const;
  std::uint64_t ResultBytes() const { return result_bytes_; }
  std::set<std::string> Ids() const;

 private:
  struct Entry {
    JobRecord record;
    std::uint64_t order = 0;  // order of creation
    std::uint64_t version = 0;
    std::vector<std::uint64_t> versions;  // for each picture, the version at which it last changed
    std::vector<Time> not_before;         // for each picture, the earliest time at which it may be
                                          // begun
    PictureCounts counts{};
    std::uint64_t result_bytes = 0;
    std::uint64_t unfetched_bytes = 0;  // the part of result_bytes that was not fetched
    std::size_t unfetched = 0;          // number of unfetched results
    std::size_t first_waiting = 0;      // no picture before this one is waiting
    // The time at which a result of the job was last drawn or fetched. The times of fetches are
    // lost at a restart.
    Time last_used = {};
    bool saved = false;
    std::optional<Problem> unwritable;  // why the job's results cannot be written
    bool was_paused = false;            // whether the job was paused at the last TakePauses
  };
  using Jobs = std::map<std::string, Entry>;

  // Bytes of unfetched results.
  struct Unfetched {
    std::uint64_t all = 0;
    std::map<std::string, std::uint64_t> by_owner;
  };

  Entry& Insert(JobRecord record);
  void Erase(Jobs::iterator job);
  JobView ViewOf(const Entry& entry, const Unfetched& unfetched) const;
  // Returns why the results of a job that has not ended cannot be written, or nothing.
  std::optional<Problem> UnwritableBecause(const Entry& entry) const;
  // Returns why the job's pictures wait, or nothing if they are begun or the job has ended.
  std::optional<Problem> PauseOf(const Entry& entry, const Unfetched& unfetched) const;
  Unfetched UnfetchedBytes() const;
  // Returns why no picture of `owner` may be begun because of unfetched results, or nothing if a
  // picture may be begun.
  std::optional<Problem> PausedBecause(const std::string& owner, const Unfetched& unfetched) const;
  // These two functions add a drawn picture to the entry's sums, or subtract it.
  void AddResult(Entry& entry, const ImageRecord& picture);
  void RemoveResult(Entry& entry, const ImageRecord& picture);
  std::size_t Unended(const Entry& entry) const;
  absl::Status CheckPictures(const NewJob& job) const;
  absl::Status MakeRoomForJob(const NewJob& job);
  // Returns the number of kept jobs and the number of their pictures, for `owner` or, if `owner` is
  // null, for all owners.
  std::pair<std::size_t, std::size_t> Kept(const std::string* owner) const;
  // Returns the jobs that have ended and whose results were all fetched, in the order in which to
  // forget them. Jobs of the owner `first_of` come first, and older jobs before newer jobs.
  std::vector<Jobs::iterator> Forgettable(const std::string& first_of);
  // Returns when the job will be ended because its results are not fetched. Returns nothing if the
  // job is not paused, or is paused only because of other jobs' results.
  std::optional<Time> AbandonedAt(const Entry& entry, const Unfetched& unfetched) const;
  void EndAbandoned(Entry& entry, Time now, Expired& expired);
  void SetState(Entry& entry, std::size_t place, PictureState state);
  void EndIfDone(Entry& entry, Time now);
  // Returns the index of the job's first picture that may be begun now, or nothing if there is no
  // such picture.
  std::optional<std::size_t> Waiting(Entry& entry, Time now) const;
  ImageRecord* Drawing(const PicturePlace& picture, Entry** entry);
  // Replaces the estimated drawing time, which Begin charged to the owner and the job, by the
  // actual time. Without a time, the estimate counts as used.
  void Settle(const PicturePlace& picture, std::optional<double> draw_ms);

  const JobLimits limits_;
  Jobs jobs_;
  std::optional<Problem> all_unwritable_;  // why no job's results can be written
  std::map<std::string, std::string> id_by_key_;
  std::uint64_t created_ = 0;
  std::uint64_t result_bytes_ = 0;
  std::set<PicturePlace> unsaved_;
  std::set<std::string> unsaved_jobs_;
  std::vector<std::string> forgotten_;
  base::FairShare owners_;
  std::map<std::string, base::FairShare> shares_;  // shares of each owner's jobs
  struct Charge {
    std::string owner;
    double expected_ms = 0.0;
  };
  std::map<PicturePlace, Charge> charges_;  // charges for the pictures that are being drawn
  double typical_ms_ = 1.0;
};

}  // namespace thunderhead::jobs
