// Render jobs: sets of pictures that are drawn in the background. The class Jobs accepts jobs
// within quotas and keeps their results. It has a few pictures drawn at a time, fairly among owners
// and their jobs. After a restart of the server, jobs continue. A picture's file is written before
// the picture is recorded as drawn. While a file cannot be written, for example because the disk is
// full, no further picture is begun. This code does not depend on the API's messages or on GL. Safe
// from any thread.
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
#include "base/whole_file.h"
#include "jobs/job_board.h"
#include "jobs/job_limits.h"
#include "jobs/job_record.h"
#include "jobs/job_store.h"
#include "jobs/job_watchers.h"
#include "jobs/picture_source.h"
#include "jobs/result_folder.h"

namespace thunderhead::jobs {

struct JobsOptions {
  std::shared_ptr<JobStore> store;  // if null, jobs are lost when the server ends
  std::string folder;               // folder of the results; if empty, jobs are disabled
  // Timeout of a call to `folder`. If a call takes longer, the folder's storage counts as hanging.
  std::chrono::milliseconds patience = std::chrono::seconds(10);
  JobLimits limits;
  // The time source for pauses, retries and timeouts of calls to the folder. It must outlive the
  // Jobs object.
  const base::TimeSource* time = &base::SteadyTime();
  WriteFile write_file = &base::WriteWholeFile;  // writes the files of the results
};

// The files of a drawn picture.
struct ResultPlace {
  std::string path;
  std::string about_path;  // path of the file with the picture's description
  std::string sha256;
  std::uint64_t bytes = 0;
};

struct JobsLoad {
  std::size_t running = 0;  // number of jobs that have not ended
  std::size_t waiting = 0;  // number of waiting pictures
  std::size_t paused = 0;   // number of waiting pictures that may not be begun until clients fetch
                            // results
  std::size_t drawing = 0;
  std::uint64_t result_bytes = 0;
  // The time in seconds for which the jobs' thread has been busy with one task, or the results
  // folder has hung. 0 if neither is the case.
  double stalled_s = 0.0;
  std::size_t watchers = 0;
};

class Jobs {
 public:
  // Called on the jobs' own thread, or on the caller's thread if the call is refused at once.
  using Done = std::function<void(const absl::StatusOr<JobView>&)>;

  // Loads the jobs from the store and removes result files that belong to no job. Does not begin
  // pictures yet.
  static absl::StatusOr<std::unique_ptr<Jobs>> Open(const JobsOptions& options);
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  // Starts drawing: from now on, pictures are begun by calling `begin`.
  void Start(BeginPicture begin);

  // Creates a job and passes its state to `done`. The error is RESOURCE_EXHAUSTED if a limit is
  // exceeded. It is UNAVAILABLE if the server accepts no new jobs (Drain), and ABORTED if a client
  // removed the job before it was saved. If the job cannot be saved, it is the error of the store.
  void Create(NewJob job, const Done& done);
  absl::StatusOr<JobNews> Get(const std::string& id, const Asker& asker) const;
  // Returns the jobs of `owner`, or of all owners if `everybodys` is true. If `label` is not empty,
  // returns only jobs with that label.
  std::vector<JobView> List(const std::string& owner, bool everybodys,
                            const std::string& label) const;
  // Cancels a job and ends its pictures at once. If `forget` is true, the job is also removed.
  // `done` is called when the change is saved, or with the error of JobBoard::Check or of the
  // store.
  void Cancel(const std::string& id, const Asker& asker, bool forget, const Done& done);

  // Notifies `watcher` of the job's changes until the watcher is destroyed. Returns the errors of
  // JobBoard::Check.
  absl::Status Watch(const std::string& id, const Asker& asker, std::weak_ptr<JobWatcher> watcher);
  // Returns the changes of a job like JobBoard::NewsOf. Returns UNAVAILABLE (base::ShuttingDown)
  // when the server has stopped.
  absl::StatusOr<std::optional<JobNews>> NewsOf(const std::string& id, std::uint64_t version) const;

  absl::StatusOr<ResultPlace> Result(const PicturePlace& picture, const Asker& asker) const;
  // Returns the result with index `place` of the job with that result key. Every client that has
  // the key may call it. Returns NOT_FOUND for an unknown key, and the errors of
  // JobBoard::ResultOf.
  absl::StatusOr<ResultPlace> ResultOfKey(const std::string& result_key, std::size_t place) const;
  // These two functions record that a client has received the whole file of a result.
  void Fetched(const PicturePlace& picture);
  void FetchedByKey(const std::string& result_key, std::size_t place);

  JobsLoad Load() const;

  // Refuses new jobs and begins no further pictures. Pictures that are being drawn continue.
  void Drain();
  // Ends the pictures that are being drawn. They will be drawn again after a restart.
  void CancelPictures();
  // Waits for the pictures that are being drawn, saves all changes, and notifies watchers. Before
  // the call, the caller must have stopped the drawing thread. Pictures whose files still cannot be
  // written are drawn again after the next start. The destructor calls Stop, too.
  void Stop();

 private:
  using Task = std::function<void()>;
  using Lock = std::unique_lock<std::mutex>;

  // A picture that was begun and has not ended.
  struct InHand {
    base::TimeSource::Clock::time_point begun_at;
    std::unique_ptr<PictureInHand> picture;  // null until the begin function has returned
    absl::Status begun;                      // the error if the picture could not be begun
    bool cancelled = false;
  };

  // A drawn picture that could not be written yet.
  struct Unwritten {
    PicturePlace place;
    std::shared_ptr<const DrawnPicture> drawn;
    double milliseconds = 0.0;  // time between its beginning and its end
  };

  Jobs(const JobsOptions& options, ResultFolder results);
  absl::Status Restore();
  void Run();
  void Post(Task task);
  // Returns the wall-clock time, shifted by the difference between time_ and
  // std::chrono::steady_clock. The shift is 0 except in tests.
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
  JobWatchers watchers_;
  std::deque<Task> tasks_;
  // The time since which the thread has been working on a task; nothing while it waits.
  std::optional<base::TimeSource::Clock::time_point> busy_since_;
  Time paused_until_ = {};            // no file is written before this time, because writing has
                                      // failed
  bool cannot_write_ = false;         // the last write of a picture failed
  std::vector<Unwritten> unwritten_;  // pictures to be written again; at most max_in_hand + 1
  bool started_ = false;
  bool draining_ = false;
  bool stopping_ = false;
  bool stopped_ = false;
  std::string last_problem_;
  std::thread thread_;
};

}  // namespace thunderhead::jobs
