#include "base/executor.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/log.h"
#include "base/out_of_memory.h"
#include "spdlog/spdlog.h"

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

absl::Status WaitedTooLong(int hanging) {
  return WithDetails(
      absl::DeadlineExceededError(absl::StrCat(
          "the server could not begin with that in time: ", hanging,
          " requests hang, perhaps with a storage that does not answer; try again later")),
      {.reason = "REQUESTS_HANG",
       .metadata = {{"hanging", absl::StrCat(hanging)}},
       .retry_after = kQueueRetryAfter});
}

}  // namespace

Executor::Executor(const Limits& limits) : shared_(std::make_shared<Shared>(limits)) {
  const std::lock_guard lock(shared_->mutex);
  for (int i = 0; i < limits.threads; ++i) AddWorker();
  watch_ = std::thread([this] { Watch(); });
}

Executor::~Executor() { Stop(); }

void Executor::AddWorker() {
  const auto worker = shared_->workers.emplace_back(std::make_shared<Worker>());
  threads_.emplace_back("a request", [shared = shared_, worker] { Work(shared, worker); });
}

void Executor::Submit(Task task) {
  absl::Status refusal;
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->stopping) {
      refusal = ShuttingDown();
    } else if (shared_->waiting.size() >= shared_->limits.max_waiting) {
      refusal = Full(shared_->limits.max_waiting);
    } else {
      shared_->waiting.push_back({std::move(task), Clock::now()});
      shared_->changed.notify_all();
      return;
    }
  }
  task(refusal);
}

int Executor::Hanging() const {
  const std::lock_guard lock(shared_->mutex);
  return static_cast<int>(std::ranges::count_if(
      shared_->workers, [](const std::shared_ptr<Worker>& worker) { return worker->hangs; }));
}

void Executor::Stop() {
  std::deque<Waiting> refused;
  std::list<LooseThread> threads;
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->stopping = true;
    refused.swap(shared_->waiting);
    threads.swap(threads_);
  }
  shared_->changed.notify_all();
  for (Waiting& waiting : refused) waiting.task(ShuttingDown());
  if (watch_.joinable()) watch_.join();
  // Those that hang are waited for together, not one after another.
  std::vector<std::thread> ending;
  for (LooseThread& thread : threads) {
    ending.emplace_back([ends = std::move(thread)] {});
  }
  for (std::thread& thread : ending) thread.join();
}

void Executor::Work(const std::shared_ptr<Shared>& shared, const std::shared_ptr<Worker>& worker) {
  std::unique_lock lock(shared->mutex);
  // Whose place another has taken does no more.
  while (!worker->hangs) {
    shared->changed.wait(lock, [&] { return shared->stopping || !shared->waiting.empty(); });
    if (shared->waiting.empty()) break;
    Task task = std::move(shared->waiting.front().task);
    shared->waiting.pop_front();
    worker->busy_since = Clock::now();
    lock.unlock();
    // The watch looks when this one would hang.
    shared->changed.notify_all();
    const absl::Status failed = OrOutOfMemory([&] {
      task(absl::OkStatus());
      return absl::OkStatus();
    });
    if (!failed.ok()) LogError(failed);
    task = nullptr;
    lock.lock();
    worker->busy_since.reset();
  }
  shared->workers.remove(worker);
}

void Executor::Replace(Clock::time_point now) {
  std::erase_if(threads_, [](const LooseThread& thread) {
    return thread.EndsWithin(std::chrono::milliseconds(0));
  });
  int hanging = static_cast<int>(std::ranges::count_if(
      shared_->workers, [](const std::shared_ptr<Worker>& worker) { return worker->hangs; }));
  const std::vector<std::shared_ptr<Worker>> workers(shared_->workers.begin(),
                                                     shared_->workers.end());
  for (const std::shared_ptr<Worker>& worker : workers) {
    if (hanging >= shared_->limits.max_hanging) return;
    if (worker->hangs || !worker->busy_since.has_value()) continue;
    if (now - *worker->busy_since < shared_->limits.hangs_after) continue;
    worker->hangs = true;
    ++hanging;
    spdlog::warn(
        "a request has run for {} s; others go on beside it",
        std::chrono::duration_cast<std::chrono::seconds>(now - *worker->busy_since).count());
    AddWorker();
  }
}

void Executor::Watch() {
  std::unique_lock lock(shared_->mutex);
  while (!shared_->stopping) {
    const Clock::time_point now = Clock::now();
    std::vector<Task> late;
    while (!shared_->waiting.empty() &&
           now - shared_->waiting.front().since >= shared_->limits.max_wait) {
      late.push_back(std::move(shared_->waiting.front().task));
      shared_->waiting.pop_front();
    }
    // Only those who wait need another thread.
    if (!shared_->waiting.empty()) Replace(now);
    if (!late.empty()) {
      lock.unlock();
      const absl::Status refusal = WaitedTooLong(Hanging());
      for (const Task& task : late) task(refusal);
      lock.lock();
      continue;
    }
    if (shared_->waiting.empty()) {
      shared_->changed.wait(lock);
    } else {
      shared_->changed.wait_for(lock, shared_->limits.hangs_after / 10);
    }
  }
}

}  // namespace thunderhead::base
