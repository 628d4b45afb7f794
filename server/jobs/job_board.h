// The state of all jobs: which pictures wait, are being drawn, or have ended and how; which picture
// is next; and which results must be evicted. A plain value; the time is an argument. Knows no
// threads, files or clocks.
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

// The person or program that makes a request about a job.
struct Asker {
  std::string name;
  bool is_operator = false;  // may access all owners' jobs
};

using PictureCounts = std::array<std::size_t, kPictureStates>;
inline std::size_t IndexOf(PictureState state) { return static_cast<std::size_t>(state); }

// The state of a job without its pictures.
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
  // Set if no picture may be begun because results must be fetched first.
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

// A job, and its pictures that changed after a given version.
struct JobNews {
  JobView job;
  std::vector<PictureView> pictures;
  std::uint64_t version = 0;
};

// Identifies a picture by its job and its place in it.
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
  // A picture that was begun this many times without an end is not begun again.
  static constexpr int kMaxAttempts = 5;

  explicit JobBoard(const JobLimits& limits) : limits_(limits) {}

  // Adds a job from a store.
  void Restore(JobRecord record, Time now);

  // Adds a job under that id. If there are too many jobs, forgets ended jobs first, the owner's own
  // before others. Jobs with unfetched results are not forgotten. RESOURCE_EXHAUSTED if that does
  // not suffice; then no job is forgotten.
  absl::Status Add(const std::string& id, const std::string& result_key, NewJob job, Time now);
  // Returns the job's record to store. The job must exist.
  const JobRecord& Record(const std::string& id) const { return jobs_.at(id).record; }
  // Allows the job's pictures to be begun. Does nothing if the job does not exist.
  void SetSaved(const std::string& id);

  // NOT_FOUND if the job does not exist; PERMISSION_DENIED if it belongs to another owner.
  absl::Status Check(const std::string& id, const Asker& asker) const;
  // Returns the changes after `version`; for version 0, everything. None if the job does not exist.
  std::optional<JobNews> NewsOf(const std::string& id, std::uint64_t version) const;
  // Returns all jobs in the order of their creation.
  std::vector<JobView> All() const;
  // NOT_FOUND if the picture has no file; FAILED_PRECONDITION if it has not ended.
  absl::StatusOr<ResultFile> ResultOf(const PicturePlace& picture) const;
  // Returns the id of the job with that result key; empty if there is none.
  std::string IdOfKey(const std::string& result_key) const;

  // Marks the next picture as being drawn and returns it. None if no picture may be begun now, for
  // example because unfetched results use up the quota.
  std::optional<PicturePlace> Begin(Time now);
  const PictureOrder& OrderOf(const PicturePlace& picture) const;
  // Returns when the next picture that was put back may be begun again; none if there is none.
  std::optional<Time> NextRetry(Time now) const;

  // Record the end of a picture that was begun. They return false if it is no longer being drawn
  // because its job was cancelled.
  bool Drawn(const PicturePlace& picture, const ResultFile& file, double milliseconds,
             double draw_ms, Time now);
  bool Fail(const PicturePlace& picture, const Problem& problem, Time now);
  // Puts the picture back, to be begun again at `not_before` or later. `counts` says whether the
  // attempt counts against the picture.
  bool PutBack(const PicturePlace& picture, bool counts, Time not_before);
  bool IsDrawing(const PicturePlace& picture) const;
  // Returns false if Begin has just taken the picture once too often.
  bool MayBegin(const PicturePlace& picture) const { return Attempts(picture) <= kMaxAttempts; }
  // Returns how often the picture was begun, without attempts that did not count. Above
  // kMaxAttempts if the picture no longer exists.
  int Attempts(const PicturePlace& picture) const;

  void Fetched(const PicturePlace& picture, Time now);
  // Cancels the job's pictures that have not ended.
  void Cancel(const std::string& id, Time now);
  void Forget(const std::string& id);
  // The outcome of Expire. The files of dropped results are to be removed.
  struct Expired {
    std::vector<ResultFile> dropped;
    std::size_t failed = 0;  // pictures that will not be drawn
  };
  // Forgets jobs that have ended and were kept long enough. Also ends jobs whose results were not
  // fetched for as long while they paused the drawing, and drops their results. Otherwise such jobs
  // would stop all drawing indefinitely.
  Expired Expire(Time now);
  // Returns when Expire has something to do next; none if it never has without other changes.
  std::optional<Time> NextExpiry() const;
  // Returns the jobs whose drawing was paused or resumed since the last call, for their watchers.
  std::vector<std::string> TakePauses();
  // Drops fetched results if the results exceed their limit, and returns them. Results of ended
  // jobs go first, then the oldest.
  std::vector<ResultFile> MakeRoom();

  // Returns the changes that are not stored yet, and marks them as saved.
  std::vector<JobChange> TakeChanges();
  // Takes changes back that could not be saved.
  void GiveBack(const std::vector<JobChange>& changes);
  // Returns the jobs that were forgotten since the last call, and assumes that the store removes
  // them.
  std::vector<std::string> TakeForgotten() { return std::exchange(forgotten_, {}); }
  // Takes ids back that could not be removed.
  void GiveBackForgotten(const std::vector<std::string>& ids);

  // Returns the counts over all jobs.
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
    std::vector<std::uint64_t> versions;  // versions at which pictures last changed
    std::vector<Time> not_before;         // earliest starts of pictures
    PictureCounts counts{};
    std::uint64_t result_bytes = 0;
    std::uint64_t unfetched_bytes = 0;  // the part of result_bytes that was not fetched
    std::size_t unfetched = 0;          // number of unfetched results
    std::size_t first_waiting = 0;      // no picture before this one is waiting
    // When a result was last drawn or fetched. A restart loses the time of fetching.
    Time last_used = {};
    bool saved = false;
    bool was_paused = false;  // as the last TakePauses saw it
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
  Unfetched UnfetchedBytes() const;
  // Returns why no picture of that owner may be begun; none if one may.
  std::optional<Problem> PausedBecause(const std::string& owner, const Unfetched& unfetched) const;
  // Adds a drawn picture to the entry's sums, or subtracts it.
  void AddResult(Entry& entry, const PictureRecord& picture);
  void RemoveResult(Entry& entry, const PictureRecord& picture);
  std::size_t Unended(const Entry& entry) const;
  absl::Status CheckPictures(const NewJob& job) const;
  absl::Status MakeRoomForJob(const NewJob& job);
  // Returns the numbers of kept jobs and their pictures, of that owner or, if null, of all owners.
  std::pair<std::size_t, std::size_t> Kept(const std::string* owner) const;
  // Returns the jobs that have ended and whose results were all fetched: first those of that owner,
  // then the oldest.
  std::vector<Jobs::iterator> Forgettable(const std::string& first_of);
  // Returns when the job ends because its results are not fetched. None if the job continues, or
  // only waits for other jobs.
  std::optional<Time> AbandonedAt(const Entry& entry, const Unfetched& unfetched) const;
  void EndAbandoned(Entry& entry, Time now, Expired& expired);
  void SetState(Entry& entry, std::size_t place, PictureState state);
  void EndIfDone(Entry& entry, Time now);
  // Returns the first picture that may be begun; none if there is none.
  std::optional<std::size_t> Waiting(Entry& entry, Time now) const;
  PictureRecord* Drawing(const PicturePlace& picture, Entry** entry);

  const JobLimits limits_;
  Jobs jobs_;
  std::map<std::string, std::string> id_by_key_;
  std::uint64_t created_ = 0;
  std::uint64_t result_bytes_ = 0;
  std::set<PicturePlace> unsaved_;
  std::set<std::string> unsaved_jobs_;
  std::vector<std::string> forgotten_;
  base::FairShare owners_;
  std::map<std::string, base::FairShare> shares_;  // shares of each owner's jobs
  std::map<PicturePlace, double> charged_ms_;      // of pictures being drawn
  double typical_ms_ = 1.0;
};

}  // namespace thunderhead::jobs
