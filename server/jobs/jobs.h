// Jobs of pictures that nobody waits for: takes them in within quotas, has them drawn a few at a
// time, fairly among owners and their jobs, keeps the results, and goes on after a restart where it
// was. A picture is written first, then recorded; while one cannot be written, as on a full disk,
// none is begun. Knows no messages and no GL; safe from any
// thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/time_source.h"
#include "jobs/job_board.h"
#include "jobs/job_limits.h"
#include "jobs/job_record.h"
#include "jobs/job_store.h"
#include "jobs/picture_source.h"
#include "jobs/result_folder.h"

namespace thunderhead::jobs {

struct JobsOptions {
  std::shared_ptr<JobStore> store;  // null: jobs end with the server
  std::string folder;               // of results; empty: there are no jobs
  // How long a call to that folder may take; then its storage hangs.
  std::chrono::milliseconds patience = std::chrono::seconds(10);
  JobLimits limits;
  // The time that pauses, retries and calls to the folder are measured by; it must outlive the
  // jobs.
  const base::TimeSource* time = &base::SteadyTime();
};

// Told that a job has changed or is gone, or that the server stops.
class JobWatcher {
 public:
  virtual ~JobWatcher() = default;
  // On any thread; must not block.
  virtual void OnJobChanged() = 0;
};

// Where a drawn picture is.
struct ResultPlace {
  std::string path;
  std::string about_path;  // what is told of it
  std::string sha256;
  std::uint64_t bytes = 0;
};

struct JobsLoad {
  std::size_t running = 0;  // jobs that have not ended
  std::size_t waiting = 0;  // pictures
  std::size_t paused = 0;   // of those that wait, as results must be fetched first
  std::size_t drawing = 0;
  std::uint64_t result_bytes = 0;
  // For how long its thread has been at one thing, or the folder of results has hung; else 0.
  double stalled_s = 0.0;
  std::size_t watchers = 0;
};

class Jobs {
 public:
  // On a thread of the jobs' own, or on the caller's if the server stops.
  using Done = std::function<void(const absl::StatusOr<JobView>&)>;

  // Reads what the store has, and removes results that belong to nothing. Begins no picture.
  static absl::StatusOr<std::unique_ptr<Jobs>> Open(const JobsOptions& options);
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  // Begins pictures from now on.
  void Start(BeginPicture begin);

  // RESOURCE_EXHAUSTED beyond the limits; UNAVAILABLE while the server drains, or if the job cannot
  // be saved.
  void Create(NewJob job, const Done& done);
  absl::StatusOr<JobNews> Get(const std::string& id, const Asker& asker) const;
  // The asker's, or everybody's; of that label unless it is empty.
  std::vector<JobView> List(const std::string& owner, bool everybodys,
                            const std::string& label) const;
  // Ends the pictures at once; `done` follows when that outlives the server.
  void Cancel(const std::string& id, const Asker& asker, bool forget, const Done& done);

  // `watcher` is told of changes until it is gone.
  absl::Status Watch(const std::string& id, const Asker& asker, std::weak_ptr<JobWatcher> watcher);
  // As JobBoard::NewsOf; SHUTTING_DOWN when the server has stopped.
  absl::StatusOr<std::optional<JobNews>> NewsOf(const std::string& id, std::uint64_t version) const;

  absl::StatusOr<ResultPlace> Result(const PicturePlace& picture, const Asker& asker) const;
  // By the job's key for results, for whoever has it; NOT_FOUND for any other.
  absl::StatusOr<ResultPlace> ResultOfKey(const std::string& result_key, std::size_t place) const;
  // Somebody has the whole file.
  void Fetched(const PicturePlace& picture);
  void FetchedByKey(const std::string& result_key, std::size_t place);

  JobsLoad Load() const;

  // Takes no more jobs and begins no more pictures; those that were begun go on.
  void Drain();
  // Ends those too; they will be begun again.
  void CancelPictures();
  // Waits for the pictures, which whoever draws them must have ended, saves, and tells watchers.
  // Pictures that still cannot be written then are drawn again after the next start.
  // The destructor does it too.
  void Stop();

 private:
  using Task = std::function<void()>;
  using Lock = std::unique_lock<std::mutex>;

  // A picture that was begun.
  struct InHand {
    base::TimeSource::Clock::time_point begun_at;
    std::unique_ptr<PictureInHand> picture;  // null until it has been begun
    absl::Status begun;                      // or why it could not be
    bool cancelled = false;
  };

  // A drawn picture that could not be written yet.
  struct Unwritten {
    PicturePlace place;
    std::shared_ptr<const DrawnPicture> drawn;
    double milliseconds = 0.0;  // since it was begun
  };

  Jobs(const JobsOptions& options, ResultFolder results);
  absl::Status Restore();
  void Run();
  void Post(Task task);
  // The wall clock. It is ahead by as much as time_ is ahead of the real steady clock.
  Time Now() const;
  base::TimeSource::Clock::time_point WakeTime() const;

  // On the thread of its own. Those that take the lock hold it when called and when they return.
  void Expire(Lock& lock);
  void BeginPictures(Lock& lock);
  void BeginOne(const PicturePlace& picture, Lock& lock);
  void EndPicture(const PicturePlace& picture);
  void Keep(Unwritten picture);
  void WriteAgain(Lock& lock);
  void Refuse(const PicturePlace& picture, const absl::Status& why);
  absl::Status Save(Lock& lock);
  void SaveNew(const std::string& id, const Done& done);
  void Tell(const std::vector<std::string>& ids, Lock& lock);
  // Needs mutex_.
  void DropGoneWatchers(const std::string& id);
  void RemoveDropped(const std::vector<ResultFile>& dropped);
  void LogOnce(const absl::Status& problem);

  ResultPlace PlaceOf(const ResultFile& file) const;
  static void CancelInHand(InHand& hand);

  const std::shared_ptr<JobStore> store_;
  ResultFolder results_;
  const JobLimits limits_;
  const base::TimeSource& time_;
  BeginPicture begin_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  JobBoard board_;
  std::map<PicturePlace, std::shared_ptr<InHand>> in_hand_;
  std::multimap<std::string, std::weak_ptr<JobWatcher>> watchers_;
  std::deque<Task> tasks_;
  // While the thread works.
  std::optional<base::TimeSource::Clock::time_point> busy_since_;
  Time paused_until_ = {};            // as nothing can be written
  bool cannot_write_ = false;         // the last of them
  std::vector<Unwritten> unwritten_;  // at most one more than may be in hand
  bool started_ = false;
  bool draining_ = false;
  bool stopping_ = false;
  bool stopped_ = false;
  std::string last_problem_;
  std::thread thread_;
};

}  // namespace thunderhead::jobs
