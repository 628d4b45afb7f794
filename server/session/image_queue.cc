#include "session/image_queue.h"

#include <chrono>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"

namespace thunderhead::session {
namespace {

// Time to draw a few pictures.
constexpr std::chrono::seconds kRetryAfter{5};

absl::Status TooMany(std::size_t waiting) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat("the server is busy: ", waiting,
                                                " pictures wait to be drawn; try again later")),
      {.reason = "RENDER_QUEUE_FULL",
       .metadata = {{"maximum", absl::StrCat(waiting)}, {"unit", "pictures"}},
       .retry_after = kRetryAfter});
}

}  // namespace

bool ImageQueue::Add(ImageJob job) {
  absl::Status refusal;
  {
    const std::lock_guard lock(mutex_);
    if (refuses_) {
      refusal = base::ShuttingDown();
    } else if (waiting_.size() >= max_waiting_) {
      refusal = TooMany(waiting_.size());
    } else {
      waiting_.push_back(std::move(job));
      return true;
    }
  }
  job.done(refusal);
  return false;
}

void ImageQueue::PutBack(ImageJob job) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(job));
}

std::size_t ImageQueue::Count() {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

std::optional<ImageJob> ImageQueue::Take() {
  std::vector<ImageJob> cancelled;
  std::optional<ImageJob> next;
  {
    const std::lock_guard lock(mutex_);
    for (auto job = waiting_.begin(); job != waiting_.end();) {
      if (*job->cancelled) {
        cancelled.push_back(std::move(*job));
        job = waiting_.erase(job);
      } else {
        ++job;
      }
    }
    if (!waiting_.empty()) {
      next = std::move(waiting_.front());
      waiting_.pop_front();
    }
  }
  for (const ImageJob& job : cancelled) {
    job.done(absl::CancelledError("the call was cancelled"));
  }
  return next;
}

void ImageQueue::RefuseAll() {
  std::deque<ImageJob> refused;
  {
    const std::lock_guard lock(mutex_);
    refuses_ = true;
    refused.swap(waiting_);
  }
  for (const ImageJob& job : refused) job.done(base::ShuttingDown());
}

}  // namespace thunderhead::session
