#include "drawing/worker.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"
#include "base/thread_priority.h"
#include "gl/device_faults.h"

namespace thunderhead::drawing {

Worker::Worker(FrameSourceFactory make_source, int niceness, std::function<void()> on_change,
               const base::TimeSource& time)
    : make_source_(std::move(make_source)),
      niceness_(niceness),
      on_change_(std::move(on_change)),
      time_(time),
      thread_([this] { Run(); }) {}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool Worker::IsIdle() const {
  const std::lock_guard lock(mutex_);
  return !busy_;
}

void Worker::Begin(Work work, Limits limits) {
  {
    const std::lock_guard lock(mutex_);
    THUNDERHEAD_CHECK(!busy_, "a worker does one piece of work at a time");
    busy_ = true;
    work_ = std::move(work);
    limits_ = std::move(limits);
    used_ms_ = 0.0;
    waited_ms_ = 0.0;
    begun_at_ = time_.Now();
    progress_at_ = begun_at_;
  }
  changed_.notify_all();
}

void Worker::FreeUnused(double unused_s) {
  std::unique_lock lock(mutex_);
  if (busy_) return;
  busy_ = true;
  frees_ = unused_s;
  changed_.notify_all();
  changed_.wait(lock, [this] { return !frees_.has_value(); });
}

void Worker::RenewSource() {
  {
    const std::lock_guard lock(mutex_);
    source_is_lost_ = true;
  }
  changed_.notify_all();
}

bool Worker::WantsTurn() {
  const std::lock_guard lock(mutex_);
  if (device_ != Device::kWanted) return false;
  if (Ended().ok()) return true;
  changed_.notify_all();
  return false;
}

double Worker::GiveTurn() {
  const Time given_at = time_.Now();
  std::unique_lock lock(mutex_);
  if (device_ != Device::kWanted || !Ended().ok()) return 0.0;
  device_ = Device::kHeld;
  waited_ms_ += base::MsSince(time_, wanted_at_);
  progress_at_ = time_.Now();
  changed_.notify_all();
  changed_.wait(lock, [this] { return device_ != Device::kHeld; });
  progress_at_ = time_.Now();
  const double took_ms = base::MsSince(time_, given_at);
  used_ms_ += took_ms;
  return took_ms;
}

double Worker::StalledSeconds() const {
  const std::lock_guard lock(mutex_);
  if (!busy_ || device_ == Device::kWanted) return 0.0;
  return 1e-3 * base::MsSince(time_, progress_at_);
}

absl::Status Worker::Ended() const {
  if (stopping_) return base::ShuttingDown();
  if (source_is_lost_) return gl::DeviceLost();
  if (limits_.cancelled != nullptr && *limits_.cancelled) {
    return absl::CancelledError("the call was cancelled");
  }
  if (WorkedMs() > limits_.max_work_ms) return limits_.too_long;
  if (used_ms_ <= limits_.max_ms) return absl::OkStatus();
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat(
          "drawing took more than the ", std::lround(1e-3 * limits_.max_ms),
          " s that the server allows for one picture; request fewer pixels or slices")),
      {.reason = "PICTURE_TOO_COSTLY",
       .metadata = {{"maximum", absl::StrCat(1e-3 * limits_.max_ms)}, {"unit", "s"}},
       .permanent = true});
}

double Worker::WorkedMs() const {
  const double waiting_ms = device_ == Device::kWanted ? base::MsSince(time_, wanted_at_) : 0.0;
  return base::MsSince(time_, begun_at_) - waited_ms_ - waiting_ms;
}

absl::Status Worker::Take() {
  std::unique_lock lock(mutex_);
  THUNDERHEAD_RETURN_IF_ERROR(Ended());
  device_ = Device::kWanted;
  wanted_at_ = time_.Now();
  lock.unlock();
  on_change_();
  lock.lock();
  changed_.wait(lock, [this] { return device_ == Device::kHeld || !Ended().ok(); });
  if (device_ == Device::kHeld) return absl::OkStatus();
  device_ = Device::kUnused;
  return Ended();
}

void Worker::GiveBack() {
  {
    const std::lock_guard lock(mutex_);
    device_ = Device::kUnused;
  }
  changed_.notify_all();
}

absl::Status Worker::Wanted() const {
  const std::lock_guard lock(mutex_);
  return Ended();
}

void Worker::Run() {
  base::LowerPriority(niceness_);
  const auto not_made = [] { return absl::UnavailableError("not made yet"); };
  absl::StatusOr<std::unique_ptr<FrameSource>> source = not_made();
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] {
      return stopping_ || source_is_lost_ || frees_.has_value() || work_ != nullptr;
    });
    if (std::exchange(source_is_lost_, false)) {
      lock.unlock();
      source = not_made();
      lock.lock();
      continue;
    }
    if (frees_.has_value()) {
      const double unused_s = *frees_;
      lock.unlock();
      if (source.ok()) (*source)->FreeUnused(unused_s);
      lock.lock();
      frees_.reset();
      busy_ = false;
      changed_.notify_all();
      continue;
    }
    if (work_ == nullptr) return;
    const Work work = std::exchange(work_, nullptr);
    lock.unlock();
    if (!source.ok()) source = make_source_(&turn_);
    work(source.ok() ? absl::StatusOr<FrameSource*>(source->get()) : source.status());
    lock.lock();
    busy_ = false;
    lock.unlock();
    on_change_();
    lock.lock();
  }
}

}  // namespace thunderhead::drawing
