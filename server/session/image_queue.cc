#include "session/image_queue.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/status.h"

namespace thunderhead::session {
namespace {

// Time to draw a few pictures.
constexpr std::chrono::seconds kQueueRetryAfter{5};

absl::Status TooMany(std::size_t waiting) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat("the server is busy: ", waiting,
                                                " pictures wait to be drawn; try again later")),
      {.reason = "RENDER_QUEUE_FULL",
       .metadata = {{"maximum", absl::StrCat(waiting)}, {"unit", "pictures"}},
       .retry_after = kQueueRetryAfter});
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
  // New ones are at the end.
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
  const auto find = [&](bool gives_way) {
    return std::ranges::find_if(waiting_, [&](const ImageJob& job) {
      return job.gives_way == gives_way && job.decided.has_value() && !*job.cancelled && suits(job);
    });
  };
  auto found = find(false);
  if (found == waiting_.end()) found = find(true);
  if (found == waiting_.end()) return std::nullopt;
  ImageJob job = std::move(*found);
  waiting_.erase(found);
  return job;
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

}  // namespace thunderhead::session
