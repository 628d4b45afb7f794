// Background jobs of pictures. Accepts jobs within quotas, has their pictures drawn a few at a
// time, fairly among owners and their jobs, and keeps the results. Continues after a restart where
// it stopped. A picture is written before it is recorded. While a picture cannot be written, for
// example on a full disk, no picture is begun. Knows no messages and no GL. Safe from any thread.
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
  std::shared_ptr<JobStore> store;  // null: jobs are lost when the server ends
  std::string folder;               // folder of results; empty: jobs are disabled
  // Timeout of a call to that folder. A longer call means that its storage hangs.
  std::chrono::milliseconds patience = std::chrono::seconds(10);
  JobLimits limits;
  // The time source for pauses, retries and calls to the folder. It must outlive the jobs.
  const base::TimeSource* time = &base::SteadyTime();
};

// A listener that is notified when a job has changed or is gone, or when the server stops.
class JobWatcher {
 public:
  virtual ~JobWatcher() = default;
  // Called on any thread; must not block.
  virtual void OnJobChanged() = 0;
};

// The files of a drawn picture.
struct ResultPlace {
  std::string path;
  std::string about_path;  // description of the picture
  std::string sha256;
  std::uint64_t bytes = 0;
};

struct JobsLoad {
  std::size_t running = 0;  // jobs that have not ended
  std::size_t waiting = 0;  // pictures
  std::size_t paused = 0;   // waiting pictures that may not start until results are fetched
  std::size_t drawing = 0;
  std::uint64_t result_bytes = 0;
  // How long the thread has been busy with one task, or the folder of results has hung; else 0.
  double stalled_s = 0.0;
  std::size_t watchers = 0;
};

class Jobs {
 public:
  // Called on the jobs' own thread, or on the caller's thread if the call is refused at once.
  using Done = std::function<void(const absl::StatusOr<JobView>&)>;

  // Reads the store and removes results that belong to no job. Begins no picture.
  static absl::StatusOr<std::unique_ptr<Jobs>> Open(const JobsOptions& options);
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  // Allows pictures to be begun.
  void Start(BeginPicture begin);

  // Creates a job. RESOURCE_EXHAUSTED beyond the limits; UNAVAILABLE while the server drains or if
  // the job cannot be saved.
  void Create(NewJob job, const Done& done);
  absl::StatusOr<JobNews> Get(const std::string& id, const Asker& asker) const;
  // Returns the owner's jobs, or all jobs if `everybodys`. If `label` is not empty, only jobs with
  // that label.
  std::vector<JobView> List(const std::string& owner, bool everybodys,
                            const std::string& label) const;
  // Ends the pictures at once. `done` is called when the cancellation is durable.
  void Cancel(const std::string& id, const Asker& asker, bool forget, const Done& done);

  // Notifies `watcher` of changes until it is destroyed.
  absl::Status Watch(const std::string& id, const Asker& asker, std::weak_ptr<JobWatcher> watcher);
  // Works like JobBoard::NewsOf. SHUTTING_DOWN when the server has stopped.
  absl::StatusOr<std::optional<JobNews>> NewsOf(const std::string& id, std::uint64_t version) const;

  absl::StatusOr<ResultPlace> Result(const PicturePlace& picture, const Asker& asker) const;
  // Returns a result by the job's result key, for anyone who has the key. NOT_FOUND for an unknown
  // key.
  absl::StatusOr<ResultPlace> ResultOfKey(const std::string& result_key, std::size_t place) const;
  // Records that a client has received the whole file.
  void Fetched(const PicturePlace& picture);
  void FetchedByKey(const std::string& result_key, std::size_t place);

  JobsLoad Load() const;

  // Refuses new jobs and begins no further pictures. Pictures that were begun continue.
  void Drain();
  // Ends the pictures that were begun, too. They will be begun again after a restart.
  void CancelPictures();
  // Waits for the pictures, saves, and notifies watchers. The caller must have ended the drawing
  // before. Pictures that still cannot be written are drawn again after the next start. The
  // destructor calls it, too.
  void Stop();

 private:
  using Task = std::function<void()>;
  using Lock = std::unique_lock<std::mutex>;

  // A picture that was begun.
  struct InHand {
    base::TimeSource::Clock::time_point begun_at;
    std::unique_ptr<PictureInHand> picture;  // null until it has been begun
    absl::Status begun;                      // error if it could not be begun
    bool cancelled = false;
  };

  // A drawn picture that could not be written yet.
  struct Unwritten {
    PicturePlace place;
    std::shared_ptr<const DrawnPicture> drawn;
    double milliseconds = 0.0;  // time since it was begun
  };

  Jobs(const JobsOptions& options, ResultFolder results);
  absl::Status Restore();
  void Run();
  void Post(Task task);
  // Returns the wall-clock time. It is shifted by the difference between time_ and the real steady
  // clock.
  Time Now() const;
  base::TimeSource::Clock::time_point WakeTime() const;

  // The following functions run on the jobs' own thread. Those with a Lock parameter hold it on
  // entry and on return.
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
  // Set while the thread works on a task.
  std::optional<base::TimeSource::Clock::time_point> busy_since_;
  Time paused_until_ = {};            // nothing can be written until then
  bool cannot_write_ = false;         // the last write of a picture failed
  std::vector<Unwritten> unwritten_;  // at most one more than the pictures in hand
  bool started_ = false;
  bool draining_ = false;
  bool stopping_ = false;
  bool stopped_ = false;
  std::string last_problem_;
  std::thread thread_;
};

}  // namespace thunderhead::jobs
