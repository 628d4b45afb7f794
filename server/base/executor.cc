#include "base/executor.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::base {
namespace {

// A task is a read or a picture's encoding; a few threads end hundreds of them in this time.
constexpr std::chrono::seconds kQueueRetryAfter{10};

absl::Status Full(std::size_t max_waiting) {
  return WithDetails(absl::ResourceExhaustedError(absl::StrCat("the server is busy: ", max_waiting,
                                                               " requests wait; try again later")),
                     {.reason = "REQUEST_QUEUE_FULL",
                      .metadata = {{"maximum", absl::StrCat(max_waiting)}, {"unit", "requests"}},
                      .retry_after = kQueueRetryAfter});
}

}  // namespace

Executor::Executor(int threads, std::size_t max_waiting) : max_waiting_(max_waiting) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Run(); });
}

Executor::~Executor() { Stop(); }

void Executor::Submit(Task task) {
  absl::Status refusal;
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) {
      refusal = ShuttingDown();
    } else if (waiting_.size() >= max_waiting_) {
      refusal = Full(max_waiting_);
    } else {
      waiting_.push_back(std::move(task));
      changed_.notify_one();
      return;
    }
  }
  task(refusal);
}

void Executor::Stop() {
  std::deque<Task> refused;
  std::vector<std::thread> threads;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    refused.swap(waiting_);
    threads.swap(threads_);
  }
  changed_.notify_all();
  for (Task& task : refused) task(ShuttingDown());
  for (std::thread& thread : threads) thread.join();
}

void Executor::Run() {
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      task = std::move(waiting_.front());
      waiting_.pop_front();
    }
    task(absl::OkStatus());
  }
}

}  // namespace thunderhead::base
