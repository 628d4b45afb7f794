// All jobs as they stand: which pictures wait, are drawn, or came to what end; who is next; what
// must make room. A plain value that is told the time: knows no threads, files or clocks.
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

// The person or program that asks about a job.
struct Asker {
  std::string name;
  bool is_operator = false;  // who may ask about everybody's
};

using PictureCounts = std::array<std::size_t, kPictureStates>;
inline std::size_t IndexOf(PictureState state) { return static_cast<std::size_t>(state); }

// A job without its pictures.
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
  // Why none of its pictures is begun now: results must be fetched first.
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

// A job, and those of its pictures that have changed since a version of it.
struct JobNews {
  JobView job;
  std::vector<PictureView> pictures;
  std::uint64_t version = 0;
};

// A picture of a job by its place.
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

  // A job of a store.
  void Restore(JobRecord record, Time now);

  // Adds a job under that id, and forgets jobs that have ended where there are too many, the
  // owner's own first; not those with results that nobody has fetched. RESOURCE_EXHAUSTED, and none
  // is forgotten, if that does not help.
  absl::Status Add(const std::string& id, const std::string& result_key, NewJob job, Time now);
  // The job as a store is to have it; it must be there.
  const JobRecord& Record(const std::string& id) const { return jobs_.at(id).record; }
  // From now on its pictures may be begun. No error if it is not there.
  void SetSaved(const std::string& id);

  // NOT_FOUND, or PERMISSION_DENIED if it is another's.
  absl::Status Check(const std::string& id, const Asker& asker) const;
  // Changes after `version`; of 0 everything. Nothing for a job that is not there.
  std::optional<JobNews> NewsOf(const std::string& id, std::uint64_t version) const;
  // In the order in which they were created.
  std::vector<JobView> All() const;
  // NOT_FOUND for a picture without a file, FAILED_PRECONDITION for one that has not ended.
  absl::StatusOr<ResultFile> ResultOf(const PicturePlace& picture) const;
  // The id of the job with that key for its results; empty if there is none.
  std::string IdOfKey(const std::string& result_key) const;

  // Marks the picture that is next as being drawn; nothing if none may be begun now, as where the
  // results that nobody has fetched leave no room.
  std::optional<PicturePlace> Begin(Time now);
  const PictureOrder& OrderOf(const PicturePlace& picture) const;
  // When the next of those that were put back may be begun again; nothing if there is none.
  std::optional<Time> NextRetry(Time now) const;

  // The ends of a picture that was begun. False if it is not being drawn any more, as its job was
  // cancelled.
  bool Drawn(const PicturePlace& picture, const ResultFile& file, double milliseconds,
             double draw_ms, Time now);
  bool Fail(const PicturePlace& picture, const Problem& problem, Time now);
  // It will be begun again, not before that time. `counts` if it was its own fault.
  bool PutBack(const PicturePlace& picture, bool counts, Time not_before);
  bool IsDrawing(const PicturePlace& picture) const;
  // False for one that Begin has just taken once too often.
  bool MayBegin(const PicturePlace& picture) const { return Attempts(picture) <= kMaxAttempts; }
  // How often it was begun, but for tries that did not count; above kMaxAttempts if it is gone.
  int Attempts(const PicturePlace& picture) const;

  void Fetched(const PicturePlace& picture, Time now);
  // Cancels what has not ended.
  void Cancel(const std::string& id, Time now);
  void Forget(const std::string& id);
  // The outcome of Expire. The files of dropped results are to be removed.
  struct Expired {
    std::vector<ResultFile> dropped;
    std::size_t failed = 0;  // pictures that will not be drawn
  };
  // Forgets what was kept long enough. Ends jobs that nobody has fetched anything of for as long
  // while they were paused for that, and drops their results: else they would stop everybody's
  // drawing for ever.
  Expired Expire(Time now);
  // When it next has something to do; nothing if never by itself.
  std::optional<Time> NextExpiry() const;
  // The jobs whose drawing was paused, or goes on, since the last call: news for who watches them.
  std::vector<std::string> TakePauses();
  // Drops results that were fetched, where there are too many: those of jobs that have ended first,
  // then the oldest. Returns them.
  std::vector<ResultFile> MakeRoom();

  // Changes that no store has yet; they are taken to be saved.
  std::vector<JobChange> TakeChanges();
  // The changes could not be saved.
  void GiveBack(const std::vector<JobChange>& changes);
  // The jobs that were forgotten since the last call; they are taken to be removed from the store.
  std::vector<std::string> TakeForgotten() { return std::exchange(forgotten_, {}); }
  // They could not be removed.
  void GiveBackForgotten(const std::vector<std::string>& ids);

  // Of all jobs.
  PictureCounts Counts() const;
  std::size_t Running() const;
  // Pictures that wait and may not be begun, as results must be fetched first.
  std::size_t Paused() const;
  std::uint64_t ResultBytes() const { return result_bytes_; }
  std::set<std::string> Ids() const;

 private:
  struct Entry {
    JobRecord record;
    std::uint64_t order = 0;  // of creation
    std::uint64_t version = 0;
    std::vector<std::uint64_t> versions;  // of pictures, when they changed last
    std::vector<Time> not_before;         // of pictures
    PictureCounts counts{};
    std::uint64_t result_bytes = 0;
    std::uint64_t unfetched_bytes = 0;  // of them, those that nobody has fetched
    std::size_t unfetched = 0;          // such results
    std::size_t first_waiting = 0;      // none before it waits
    // When a result was drawn or fetched last; not kept over a restart if it was fetched.
    Time last_used = {};
    bool saved = false;
    bool was_paused = false;  // as TakePauses saw it last
  };
  using Jobs = std::map<std::string, Entry>;

  // Bytes of results that nobody has fetched.
  struct Unfetched {
    std::uint64_t all = 0;
    std::map<std::string, std::uint64_t> by_owner;
  };

  Entry& Insert(JobRecord record);
  void Erase(Jobs::iterator job);
  JobView ViewOf(const Entry& entry, const Unfetched& unfetched) const;
  Unfetched UnfetchedBytes() const;
  // Why no picture of that owner may be begun; nothing if one may.
  std::optional<Problem> PausedBecause(const std::string& owner, const Unfetched& unfetched) const;
  // Adds a drawn picture to the entry's sums, or takes it from them.
  void AddResult(Entry& entry, const PictureRecord& picture);
  void RemoveResult(Entry& entry, const PictureRecord& picture);
  std::size_t Unended(const Entry& entry) const;
  absl::Status CheckPictures(const NewJob& job) const;
  absl::Status MakeRoomForJob(const NewJob& job);
  // Jobs and their pictures, of that owner; null: of everybody.
  std::pair<std::size_t, std::size_t> Kept(const std::string* owner) const;
  // Those that have ended and whose results were all fetched: of that owner first, then the oldest.
  std::vector<Jobs::iterator> Forgettable(const std::string& first_of);
  // When that job ends as nobody fetches; nothing if it goes on, or waits for other jobs alone.
  std::optional<Time> AbandonedAt(const Entry& entry, const Unfetched& unfetched) const;
  void EndAbandoned(Entry& entry, Time now, Expired& expired);
  void SetState(Entry& entry, std::size_t place, PictureState state);
  void EndIfDone(Entry& entry, Time now);
  // The first that may be begun; nothing if there is none.
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
  std::map<std::string, base::FairShare> shares_;  // of an owner's jobs
  std::map<PicturePlace, double> charged_ms_;      // of those being drawn
  double typical_ms_ = 1.0;
};

}  // namespace thunderhead::jobs
