#include "jobs/jobs.h"

#include <algorithm>
#include <chrono>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/log.h"
#include "base/random_hex.h"
#include "base/status.h"
#include "jobs/next_try.h"
#include "pipeline/sha256.h"
#include "spdlog/spdlog.h"
#include "telemetry/metrics.h"

namespace thunderhead::jobs {
namespace {

constexpr int kIdWords = kIdDigits / 8;
// Pause before results are written again after a write has failed, for example on a full disk.
constexpr std::chrono::seconds kUnwrittenPause{5};
// Pause before a picture is drawn again if its job's folder is not writable.
constexpr std::chrono::seconds kUnwritablePause{60};
// The longest sleep. It is limited because the system clock may be set while the thread sleeps.
constexpr std::chrono::seconds kLongestSleep{60};

void Count(const char* outcome, std::size_t pictures = 1) {
  telemetry::Counted().job_pictures.Of(outcome).Add(pictures);
}

Problem ProblemOf(const absl::Status& status) {
  return {status.code(), base::DetailsOf(status).reason, std::string(status.message())};
}

Problem NotWritten(const absl::Status& status) {
  Problem problem = ProblemOf(status);
  if (problem.reason.empty()) problem.reason = "RESULTS_NOT_WRITTEN";
  problem.message = absl::StrCat("pictures wait until they can be written: ", problem.message);
  return problem;
}

Problem EndedServer() {
  return {absl::StatusCode::kInternal, "PICTURE_ENDED_SERVER",
          absl::StrCat("it was begun ", JobBoard::kMaxAttempts,
                       " times, and each time the server ended before it was drawn")};
}

}  // namespace

absl::StatusOr<std::unique_ptr<Jobs>> Jobs::Open(const JobsOptions& options) {
  THUNDERHEAD_ASSIGN_OR_RETURN(
      ResultFolder results,
      ResultFolder::Open(options.folder, options.patience, *options.time, options.write_file));
  std::unique_ptr<Jobs> jobs(new Jobs(options, std::move(results)));
  THUNDERHEAD_RETURN_IF_ERROR(jobs->Restore());
  jobs->thread_ = std::thread([raw = jobs.get()] { raw->Run(); });
  return jobs;
}

Jobs::Jobs(const JobsOptions& options, ResultFolder results)
    : store_(options.store),
      results_(std::move(results)),
      limits_(options.limits),
      time_(*options.time),
      board_(options.limits) {}

Jobs::~Jobs() { Stop(); }

absl::Status Jobs::Restore() {
  if (store_ != nullptr) {
    THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<JobRecord> records, store_->Load());
    for (JobRecord& record : records) board_.Restore(std::move(record), Now());
  }
  Lock lock(mutex_);
  Expire(lock);
  results_.Clean(board_.Ids());
  return absl::OkStatus();
}

void Jobs::Start(BeginPicture begin) {
  {
    const std::lock_guard lock(mutex_);
    begin_ = std::move(begin);
    started_ = true;
  }
  changed_.notify_all();
}

void Jobs::Post(Task task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  changed_.notify_all();
}

void Jobs::Create(NewJob job, const Done& done) {
  const std::string id = base::RandomHex(kIdWords);
  absl::Status status;
  {
    const std::lock_guard lock(mutex_);
    status = draining_ ? base::ShuttingDown()
                       : board_.Add(id, base::RandomHex(kIdWords), std::move(job), Now());
    if (status.ok()) tasks_.push_back([this, id, done] { SaveNew(id, done); });
  }
  if (!status.ok()) return done(status);
  changed_.notify_all();
}

void Jobs::SaveNew(const std::string& id, const Done& done) {
  Lock lock(mutex_);
  // The job may no longer exist, because List returns it already and a client may have removed it
  // meanwhile.
  std::optional<JobNews> news = board_.NewsOf(id, 0);
  if (!news.has_value()) {
    lock.unlock();
    return done(absl::AbortedError("the render job was forgotten before it was saved"));
  }
  const JobRecord record = board_.Record(id);
  lock.unlock();
  const absl::Status saved = store_ == nullptr ? absl::OkStatus() : store_->Add(record);
  lock.lock();
  if (saved.ok()) {
    board_.SetSaved(id);
  } else {
    board_.Forget(id);
  }
  lock.unlock();
  if (!saved.ok()) return done(base::Annotate(saved, "the render job cannot be kept"));
  done(std::move(news->job));
}

absl::StatusOr<JobNews> Jobs::Get(const std::string& id, const Asker& asker) const {
  const std::lock_guard lock(mutex_);
  THUNDERHEAD_RETURN_IF_ERROR(board_.Check(id, asker));
  return *board_.NewsOf(id, 0);
}

std::vector<JobView> Jobs::List(const std::string& owner, bool everybodys,
                                const std::string& label) const {
  std::vector<JobView> views;
  {
    const std::lock_guard lock(mutex_);
    views = board_.All();
  }
  std::erase_if(views, [&](const JobView& job) {
    return (!everybodys && job.owner != owner) || (!label.empty() && job.label != label);
  });
  return views;
}

void Jobs::Cancel(const std::string& id, const Asker& asker, bool forget, const Done& done) {
  absl::StatusOr<JobView> view = JobView();
  {
    const std::lock_guard lock(mutex_);
    if (const absl::Status wrong = board_.Check(id, asker); !wrong.ok()) {
      view = wrong;
    } else if (stopped_) {
      view = base::ShuttingDown();
    } else {
      board_.Cancel(id, Now());
      view = board_.NewsOf(id, 0)->job;
      if (forget) board_.Forget(id);
      for (const auto& [picture, hand] : in_hand_) {
        if (picture.job_id == id) CancelInHand(*hand);
      }
      tasks_.push_back([this, view, done] {
        Lock saving(mutex_);
        const absl::Status saved = Save(saving);
        saving.unlock();
        done(saved.ok() ? view : saved);
      });
    }
  }
  if (!view.ok()) return done(view);
  changed_.notify_all();
}

void Jobs::CancelInHand(InHand& hand) {
  hand.cancelled = true;
  if (hand.picture != nullptr) hand.picture->Cancel();
}

absl::Status Jobs::Watch(const std::string& id, const Asker& asker,
                         std::weak_ptr<JobWatcher> watcher) {
  const std::lock_guard lock(mutex_);
  THUNDERHEAD_RETURN_IF_ERROR(board_.Check(id, asker));
  watchers_.Add(id, std::move(watcher));
  return absl::OkStatus();
}

absl::StatusOr<std::optional<JobNews>> Jobs::NewsOf(const std::string& id,
                                                    std::uint64_t version) const {
  const std::lock_guard lock(mutex_);
  if (stopped_) return base::ShuttingDown();
  return board_.NewsOf(id, version);
}

ResultPlace Jobs::PlaceOf(const ResultFile& file) const {
  const PicturePlace& picture = file.picture;
  return {results_.PathOf(picture.job_id, picture.place, file.extension),
          results_.AboutPathOf(picture.job_id, picture.place), file.sha256, file.bytes};
}

absl::StatusOr<ResultPlace> Jobs::Result(const PicturePlace& picture, const Asker& asker) const {
  const std::lock_guard lock(mutex_);
  THUNDERHEAD_RETURN_IF_ERROR(board_.Check(picture.job_id, asker));
  THUNDERHEAD_ASSIGN_OR_RETURN(const ResultFile file, board_.ResultOf(picture));
  return PlaceOf(file);
}

absl::StatusOr<ResultPlace> Jobs::ResultOfKey(const std::string& result_key,
                                              std::size_t place) const {
  const std::lock_guard lock(mutex_);
  const std::string id = board_.IdOfKey(result_key);
  if (id.empty()) return absl::NotFoundError("no render job has this key");
  THUNDERHEAD_ASSIGN_OR_RETURN(const ResultFile file, board_.ResultOf({id, place}));
  return PlaceOf(file);
}

void Jobs::Fetched(const PicturePlace& picture) {
  {
    const std::lock_guard lock(mutex_);
    board_.Fetched(picture, Now());
  }
  // The quota may have free space now, so the thread must check for pictures to begin. An empty
  // task wakes it, because it would miss a notification while it is saving.
  Post([] {});
}

void Jobs::FetchedByKey(const std::string& result_key, std::size_t place) {
  std::string id;
  {
    const std::lock_guard lock(mutex_);
    id = board_.IdOfKey(result_key);
  }
  Fetched({id, place});
}

JobsLoad Jobs::Load() const {
  const std::lock_guard lock(mutex_);
  const PictureCounts counts = board_.Counts();
  const std::chrono::duration<double> busy =
      busy_since_.has_value() ? time_.Now() - *busy_since_ : base::TimeSource::Clock::duration(0);
  return {.running = board_.Running(),
          .waiting = counts[static_cast<std::size_t>(PictureState::kWaiting)],
          .paused = board_.Paused(),
          .drawing = counts[static_cast<std::size_t>(PictureState::kDrawing)],
          .result_bytes = board_.ResultBytes(),
          .stalled_s = std::max(busy.count(), results_.HangingSeconds()),
          .watchers = watchers_.Size()};
}

void Jobs::Drain() {
  const std::lock_guard lock(mutex_);
  draining_ = true;
}

void Jobs::CancelPictures() {
  const std::lock_guard lock(mutex_);
  draining_ = true;
  for (const auto& [picture, hand] : in_hand_) CancelInHand(*hand);
}

void Jobs::Stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    draining_ = true;
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

Time Jobs::Now() const {
  return std::chrono::system_clock::now() + (time_.Now() - base::SteadyTime().Now());
}

base::TimeSource::Clock::time_point Jobs::WakeTime() const {
  const Time now = Now();
  Time wake = now + kLongestSleep;
  for (const std::optional<Time>& at : {board_.NextRetry(now), board_.NextExpiry()}) {
    if (at.has_value()) wake = std::min(wake, *at);
  }
  // Unwritten pictures are written again when the pause is over, which may already be the case.
  if (paused_until_ > now || !unwritten_.empty()) wake = std::min(wake, paused_until_);
  return time_.Now() + (wake - now);
}

void Jobs::Run() {
  Lock lock(mutex_);
  while (true) {
    Expire(lock);
    WriteAgain(lock);
    BeginPictures(lock);
    (void)Save(lock);
    Tell(board_.TakePauses(), lock);
    const bool ends = stopping_ && in_hand_.empty() && tasks_.empty();
    if (ends && unwritten_.empty()) break;
    busy_since_.reset();
    if (tasks_.empty() && !ends) changed_.wait_until(lock, time_.LookAgainAt(WakeTime()));
    busy_since_ = time_.Now();
    while (!tasks_.empty()) {
      const Task task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
      lock.lock();
      busy_since_ = time_.Now();
    }
  }
  stopped_ = true;
  Tell(watchers_.Watched(), lock);
}

void Jobs::Expire(Lock& lock) {
  const JobBoard::Expired expired = board_.Expire(Now());
  if (expired.dropped.empty() && expired.failed == 0) return;
  spdlog::warn(
      "{} pictures of render jobs are not drawn, and {} results are deleted, because results were "
      "not fetched in time",
      expired.failed, expired.dropped.size());
  Count("failed", expired.failed);
  lock.unlock();
  RemoveDropped(expired.dropped);
  lock.lock();
}

void Jobs::RemoveDropped(const std::vector<ResultFile>& dropped) {
  for (const ResultFile& old : dropped) {
    results_.Remove(old.picture.job_id, old.picture.place, old.extension);
  }
  Count("dropped", dropped.size());
}

void Jobs::BeginPictures(Lock& lock) {
  // No picture is begun while others wait to be written, even after the pause. Writing may take
  // longer than the pause, so more and more unwritten pictures would collect in memory.
  while (started_ && !draining_ && in_hand_.size() < limits_.max_in_hand && unwritten_.empty() &&
         paused_until_ <= Now()) {
    const std::optional<PicturePlace> picture = board_.Begin(Now());
    if (!picture.has_value()) return;
    BeginOne(*picture, lock);
  }
}

void Jobs::BeginOne(const PicturePlace& picture, Lock& lock) {
  if (!board_.MayBegin(picture)) {
    board_.Fail(picture, EndedServer(), Now());
    Count("failed");
    return;
  }
  // The attempt is recorded before the picture is begun. A picture that crashes the server is
  // therefore not drawn again and again.
  if (!Save(lock).ok()) {
    board_.PutBack(picture, false, Now());
    return;
  }
  if (!board_.IsDrawing(picture)) return;
  const PictureOrder order = board_.OrderOf(picture);
  const auto hand = std::make_shared<InHand>();
  hand->begun_at = time_.Now();
  in_hand_[picture] = hand;
  lock.unlock();
  const auto ends = [this, picture] { Post([this, picture] { EndPicture(picture); }); };
  std::unique_ptr<PictureInHand> begun;
  const absl::Status begins = base::Guarded([&] {
    begun = begin_(order, ends);
    return absl::OkStatus();
  });
  lock.lock();
  hand->begun = begins;
  hand->picture = std::move(begun);
  if (hand->picture == nullptr) {
    lock.unlock();
    ends();
    lock.lock();
  } else if (hand->cancelled) {
    hand->picture->Cancel();
  }
}

void Jobs::EndPicture(const PicturePlace& picture) {
  Lock lock(mutex_);
  const std::shared_ptr<InHand> hand = in_hand_.extract(picture).mapped();
  // The next picture is drawn while this one is written.
  BeginPictures(lock);
  lock.unlock();
  const absl::Status kept = base::Guarded([&]() -> absl::Status {
    THUNDERHEAD_RETURN_IF_ERROR(hand->begun);
    THUNDERHEAD_ASSIGN_OR_RETURN(DrawnPicture drawn, hand->picture->Take());
    Keep({picture, std::make_shared<const DrawnPicture>(std::move(drawn)),
          std::chrono::duration<double, std::milli>(time_.Now() - hand->begun_at).count()});
    return absl::OkStatus();
  });
  if (!kept.ok()) Refuse(picture, kept);
  lock.lock();
  (void)Save(lock);
}

void Jobs::WriteAgain(Lock& lock) {
  if (stopping_) {
    for (const Unwritten& picture : unwritten_) board_.PutBack(picture.place, false, Now());
    unwritten_.clear();
  }
  if (unwritten_.empty() || paused_until_ > Now()) return;
  std::vector<Unwritten> pictures = std::exchange(unwritten_, {});
  lock.unlock();
  for (Unwritten& picture : pictures) {
    const PicturePlace place = picture.place;
    const absl::Status kept = base::Guarded([&] {
      Keep(std::move(picture));
      return absl::OkStatus();
    });
    if (!kept.ok()) Refuse(place, kept);
  }
  lock.lock();
  if (unwritten_.empty()) board_.SetAllUnwritable(std::nullopt);
}

void Jobs::Keep(Unwritten picture) {
  const auto& [job_id, place] = picture.place;
  const DrawnPicture& drawn = *picture.drawn;
  Lock lock(mutex_);
  if (!board_.IsDrawing(picture.place)) return;
  lock.unlock();
  const ResultFile file{picture.place, drawn.extension, pipeline::Sha256(drawn.bytes),
                        drawn.bytes.size()};
  const absl::Status written = results_.Write(job_id, place, picture.drawn);
  lock.lock();
  board_.SetUnwritable(job_id, std::nullopt);
  if (!written.ok() && !std::exchange(cannot_write_, true)) {
    base::LogError(
        base::Annotate(written, "pictures of render jobs wait until they can be written"));
  }
  // Possibly only this job's folder cannot be written, for example because it belongs to another
  // user. Other jobs therefore continue.
  if (absl::IsFailedPrecondition(written)) {
    board_.SetUnwritable(job_id, NotWritten(written));
    board_.PutBack(picture.place, false, Now() + kUnwritablePause);
    return;
  }
  if (!written.ok()) {
    board_.SetAllUnwritable(NotWritten(written));
    paused_until_ = Now() + kUnwrittenPause;
    unwritten_.push_back(std::move(picture));
    return;
  }
  cannot_write_ = false;
  const bool kept = board_.Drawn(picture.place, file, picture.milliseconds, drawn.draw_ms, Now());
  const std::vector<ResultFile> dropped = board_.MakeRoom();
  lock.unlock();
  if (kept) {
    Count("drawn");
  } else {
    results_.Remove(job_id, place, drawn.extension);
  }
  RemoveDropped(dropped);
}

void Jobs::Refuse(const PicturePlace& picture, const absl::Status& why) {
  const Lock lock(mutex_);
  const std::optional<NextTry> next = NextTryAfter(why, board_.Attempts(picture), draining_);
  if (next.has_value()) {
    board_.PutBack(picture, next->counts, Now() + next->pause);
    return;
  }
  if (board_.Fail(picture, ProblemOf(why), Now())) Count("failed");
}

absl::Status Jobs::Save(Lock& lock) {
  const std::vector<JobChange> changes = board_.TakeChanges();
  const std::vector<std::string> forgotten = board_.TakeForgotten();
  if (changes.empty() && forgotten.empty()) return absl::OkStatus();
  lock.unlock();
  absl::Status saved;
  absl::Status removed;
  if (store_ != nullptr) {
    if (!changes.empty()) saved = store_->Save(changes);
    if (!forgotten.empty()) removed = store_->Remove(forgotten);
  }
  // Files are removed only after the records are removed from the store, because every record in
  // the store must have its files.
  if (removed.ok()) {
    for (const std::string& id : forgotten) results_.Remove(id);
  }
  lock.lock();
  if (!saved.ok()) board_.GiveBack(changes);
  // Removing the jobs from the store must be tried again. Otherwise a cancelled job would be drawn
  // again after a restart.
  if (!removed.ok()) board_.GiveBackForgotten(forgotten);
  saved.Update(removed);
  if (saved.ok()) {
    last_problem_.clear();
  } else {
    paused_until_ = Now() + kUnwrittenPause;
    LogOnce(base::Annotate(saved, "cannot save render jobs; trying again"));
  }
  std::vector<std::string> ids = forgotten;
  for (const JobChange& change : changes) ids.push_back(change.id);
  Tell(ids, lock);
  for (const std::string& id : forgotten) watchers_.Forget(id);
  return saved;
}

void Jobs::Tell(const std::vector<std::string>& ids, Lock& lock) {
  std::vector<std::shared_ptr<JobWatcher>> told = watchers_.Of(ids);
  lock.unlock();
  for (const auto& watcher : told) watcher->OnJobChanged();
  told.clear();
  lock.lock();
}

void Jobs::LogOnce(const absl::Status& problem) {
  std::string text(problem.message());
  if (text == last_problem_) return;
  last_problem_ = std::move(text);
  base::LogError(problem);
}

}  // namespace thunderhead::jobs
