#include "drawing/image_queue.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"

namespace thunderhead::drawing {
namespace {

// Retry delay when the queue is full: about the time to draw a few pictures.
constexpr std::chrono::seconds kQueueRetryAfter{5};

absl::Status TooManyWaiting(const char* of_whom, std::size_t waiting) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat("the server is busy: ", waiting, of_whom,
                                                " pictures wait to be drawn; try again later")),
      {.reason = "RENDER_QUEUE_FULL",
       .metadata = {{"maximum", absl::StrCat(waiting)}, {"unit", "pictures"}},
       .retry_after = kQueueRetryAfter});
}

}  // namespace

std::size_t ImageQueue::WaitingOf(const std::string& owner) const {
  return static_cast<std::size_t>(std::ranges::count(waiting_, owner, &ImageJob::owner));
}

bool ImageQueue::Add(ImageJob job) {
  absl::Status refusal;
  {
    const std::lock_guard lock(mutex_);
    if (refuses_) {
      refusal = base::ShuttingDown();
    } else if (waiting_.size() >= max_waiting_) {
      refusal = TooManyWaiting("", waiting_.size());
    } else if (!job.owner.empty() && WaitingOf(job.owner) >= max_waiting_each_) {
      refusal = TooManyWaiting(" of your", max_waiting_each_);
    } else {
      waiting_.push_back(std::move(job));
      return true;
    }
  }
  job.done(refusal);
  return false;
}

std::deque<ImageJob> ImageQueue::Extract(const std::function<bool(const ImageJob&)>& is) {
  std::deque<ImageJob> extracted;
  const std::lock_guard lock(mutex_);
  for (auto job = waiting_.begin(); job != waiting_.end();) {
    if (is(*job)) {
      extracted.push_back(std::move(*job));
      job = waiting_.erase(job);
    } else {
      ++job;
    }
  }
  return extracted;
}

void ImageQueue::Admit(const std::function<absl::Status(ImageJob&)>& admit) {
  // The order is kept: new jobs are taken out of the queue, and the admitted ones are appended.
  std::deque<ImageJob> fresh =
      Extract([](const ImageJob& job) { return !job.decided.has_value(); });
  for (ImageJob& job : fresh) {
    if (absl::Status refused = admit(job); !refused.ok()) {
      job.done(std::move(refused));
      continue;
    }
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(job));
  }
}

std::optional<ImageJob> ImageQueue::Take(const std::function<bool(const ImageJob&)>& suits) {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::deque<ImageJob>::iterator> first;  // by owner
  std::vector<std::string> owners;
  auto found = waiting_.end();  // first suitable background job
  for (auto job = waiting_.begin(); job != waiting_.end(); ++job) {
    if (!job->decided.has_value() || *job->cancelled) continue;
    if (!job->gives_way) owners.push_back(job->owner);
    if (!suits(*job)) continue;
    if (!job->gives_way) first.emplace(job->owner, job);
    if (job->gives_way && found == waiting_.end()) found = job;
  }
  if (!owners.empty()) {
    const auto owner =
        owners_.Next(owners, [&](const std::string& one) { return first.contains(one); });
    if (owner.has_value()) found = first.at(*owner);
  }
  if (found == waiting_.end()) return std::nullopt;
  ImageJob job = std::move(*found);
  waiting_.erase(found);
  job.charged_ms = job.predicted_ms;
  if (!job.gives_way) owners_.Charge(job.owner, job.charged_ms);
  return job;
}

void ImageQueue::Settle(const ImageJob& job, std::optional<double> milliseconds) {
  const std::lock_guard lock(mutex_);
  if (job.gives_way) return;
  owners_.Settle(job.owner, job.charged_ms, milliseconds.value_or(job.charged_ms));
}

void ImageQueue::DropCancelled() {
  for (const ImageJob& job :
       Extract([](const ImageJob& waits) { return waits.cancelled->load(); })) {
    job.done(absl::CancelledError("the call was cancelled"));
  }
}

std::size_t ImageQueue::Waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
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

}  // namespace thunderhead::drawing
