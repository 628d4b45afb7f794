#include "base/executor.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/guarded.h"
#include "base/log.h"
#include "spdlog/spdlog.h"

namespace thunderhead::base {
namespace {

// The retry delay when the queue is full. A task reads a file or encodes an image, so a few threads
// finish hundreds of tasks in this time.
constexpr std::chrono::seconds kQueueRetryAfter{10};

// The time after which a worker tries again to start a task, if it lacked the memory to start it.
constexpr std::chrono::milliseconds kMemoryPause{100};

absl::Status Full(const char* of_whom, std::size_t max_waiting) {
  return WithDetails(
      absl::ResourceExhaustedError(absl::StrCat("the server is busy: ", max_waiting, of_whom,
                                                " requests wait; try again later")),
      {.reason = "REQUEST_QUEUE_FULL",
       .metadata = {{"maximum", absl::StrCat(max_waiting)}, {"unit", "requests"}},
       .retry_after = kQueueRetryAfter});
}

absl::Status WaitedTooLong(int hanging) {
  return WithDetails(
      absl::DeadlineExceededError(absl::StrCat(
          "the server could not begin this request in time: ", hanging,
          " requests hang, perhaps on a storage that does not answer; try again later")),
      {.reason = "REQUESTS_HANG",
       .metadata = {{"hanging", absl::StrCat(hanging)}},
       .retry_after = kQueueRetryAfter});
}

}  // namespace

Executor::Executor(const Limits& limits, const TimeSource& time)
    : shared_(std::make_shared<Shared>(limits, time)) {
  const std::lock_guard lock(shared_->mutex);
  for (int i = 0; i < limits.threads; ++i) AddWorker();
  watch_ = std::thread([this] { Watch(); });
}

Executor::~Executor() { Stop(); }

void Executor::AddWorker() {
  const auto worker = shared_->workers.emplace_back(std::make_shared<Worker>());
  try {
    threads_.emplace_back(
        "a request", [shared = shared_, worker] { Work(shared, worker); }, shared_->time);
  } catch (...) {
    shared_->workers.remove(worker);
    throw;
  }
}

void Executor::Submit(const std::string& owner, Task task) {
  absl::Status refusal;
  {
    const std::lock_guard lock(shared_->mutex);
    const Limits& limits = shared_->limits;
    const auto own = shared_->waiting.find(owner);
    if (shared_->stopping) {
      refusal = ShuttingDown();
    } else if (shared_->waiting_count >= limits.max_waiting) {
      refusal = Full("", limits.max_waiting);
    } else if (!owner.empty() && own != shared_->waiting.end() &&
               own->second.size() >= limits.max_waiting_each) {
      refusal = Full(" of your", limits.max_waiting_each);
    } else {
      const auto queue = shared_->waiting.try_emplace(owner).first;
      try {
        queue->second.push_back({std::move(task), shared_->time.Now()});
      } catch (...) {
        if (queue->second.empty()) shared_->waiting.erase(queue);
        throw;
      }
      ++shared_->waiting_count;
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
  std::map<std::string, std::deque<Waiting>> refused;
  std::list<LooseThread> threads;
  Clock::time_point deadline;
  {
    const std::lock_guard lock(shared_->mutex);
    deadline = shared_->time.Now() + LooseThread::kPatience;
    shared_->stopping = true;
    refused.swap(shared_->waiting);
    shared_->waiting_count = 0;
    threads.swap(threads_);
  }
  shared_->changed.notify_all();
  for (const auto& [owner, tasks] : refused) {
    for (const Waiting& waiting : tasks) waiting.task(ShuttingDown());
  }
  if (watch_.joinable()) watch_.join();
  // One deadline covers all threads, so that hanging threads do not add up to a long wait.
  for (LooseThread& thread : threads) thread.LetGoBy(deadline);
}

std::optional<Executor::Task> Executor::Take(Shared& shared, Worker& worker) {
  if (shared.waiting.empty()) return std::nullopt;
  const int max_of_one = std::max(1, shared.limits.threads - 1);
  std::vector<std::string> owners;
  for (const auto& [owner, tasks] : shared.waiting) owners.push_back(owner);
  std::optional<std::string> owner = shared.shares.Next(owners, [&](const std::string& one) {
    const auto running = shared.running.find(one);
    return one.empty() || running == shared.running.end() || running->second < max_of_one;
  });
  if (!owner.has_value()) return std::nullopt;
  int& running = shared.running[*owner];
  // Nothing below this line allocates, so a task that was taken from the queue is always run.
  const auto queue = shared.waiting.find(*owner);
  Task task = std::move(queue->second.front().task);
  queue->second.pop_front();
  if (queue->second.empty()) shared.waiting.erase(queue);
  --shared.waiting_count;
  ++running;
  worker.owner = *std::move(owner);
  worker.busy_since = shared.time.Now();
  // The duration of the previous task is charged as an estimate. End replaces it by this task's own
  // duration.
  worker.charged_ms = shared.typical_ms;
  shared.shares.Charge(worker.owner, worker.charged_ms);
  return task;
}

void Executor::Leave(Shared& shared, const std::string& owner) {
  const auto running = shared.running.find(owner);
  if (--running->second == 0) shared.running.erase(running);
}

void Executor::End(Shared& shared, Worker& worker) {
  const std::chrono::duration<double, std::milli> took = shared.time.Now() - *worker.busy_since;
  worker.busy_since.reset();
  shared.shares.Settle(worker.owner, worker.charged_ms, took.count());
  if (worker.hangs) return;
  shared.typical_ms = took.count();
  Leave(shared, worker.owner);
}

std::optional<Executor::Task> Executor::WaitFor(Shared& shared, Worker& worker,
                                                std::unique_lock<std::mutex>& lock) {
  while (true) {
    try {
      std::optional<Task> task = Take(shared, worker);
      if (task.has_value() || shared.stopping) return task;
      shared.changed.wait(lock);
    } catch (const std::bad_alloc&) {
      // The task stays in the queue, so it is not lost.
      shared.changed.wait_for(lock, kMemoryPause);
      if (shared.stopping) return std::nullopt;
    }
  }
}

void Executor::Work(const std::shared_ptr<Shared>& shared, const std::shared_ptr<Worker>& worker) {
  std::unique_lock lock(shared->mutex);
  // A worker that was replaced because it hung exits.
  while (!worker->hangs) {
    std::optional<Task> task = WaitFor(*shared, *worker, lock);
    if (!task.has_value()) break;
    lock.unlock();
    // The notification wakes the watch thread, which must then wait until this task would count as
    // hanging.
    shared->changed.notify_all();
    try {
      const absl::Status failed = Guarded([&] {
        (*task)(absl::OkStatus());
        return absl::OkStatus();
      });
      if (!failed.ok()) LogError(failed);
    } catch (const std::bad_alloc&) {
      // The failure is not logged, because there is no memory for the log line.
    }
    task.reset();
    lock.lock();
    End(*shared, *worker);
    // Tasks of this owner may have waited for this task to end, so the threads look for work again.
    shared->changed.notify_all();
  }
  shared->workers.remove(worker);
}

void Executor::Replace(Clock::time_point now) {
  std::erase_if(threads_, [](const LooseThread& thread) { return thread.HasEnded(); });
  int hanging = static_cast<int>(std::ranges::count_if(
      shared_->workers, [](const std::shared_ptr<Worker>& worker) { return worker->hangs; }));
  const std::vector<std::shared_ptr<Worker>> workers(shared_->workers.begin(),
                                                     shared_->workers.end());
  for (const std::shared_ptr<Worker>& worker : workers) {
    if (hanging >= shared_->limits.max_hanging) return;
    if (worker->hangs || !worker->busy_since.has_value()) continue;
    if (now - *worker->busy_since < shared_->limits.hangs_after) continue;
    // The new thread is added before the worker is marked as hanging, because adding a thread can
    // fail for lack of memory.
    AddWorker();
    worker->hangs = true;
    Leave(*shared_, worker->owner);
    ++hanging;
    spdlog::warn(
        "a request has run for {} s; another thread handles the requests that wait",
        std::chrono::duration_cast<std::chrono::seconds>(now - *worker->busy_since).count());
  }
}

std::vector<Executor::Task> Executor::TakeLate(Shared& shared, Clock::time_point now) {
  std::vector<Task> late;
  // Reserves memory before any task is taken from the queue, because an allocation can fail.
  late.reserve(shared.waiting_count);
  for (auto owner = shared.waiting.begin(); owner != shared.waiting.end();) {
    std::deque<Waiting>& tasks = owner->second;
    while (!tasks.empty() && now - tasks.front().since >= shared.limits.max_wait) {
      late.push_back(std::move(tasks.front().task));
      tasks.pop_front();
      --shared.waiting_count;
    }
    owner = tasks.empty() ? shared.waiting.erase(owner) : std::next(owner);
  }
  return late;
}

void Executor::Watch() {
  std::unique_lock lock(shared_->mutex);
  while (!shared_->stopping) {
    const Clock::time_point now = shared_->time.Now();
    std::vector<Task> late;
    try {
      late = TakeLate(*shared_, now);
      // A hanging thread needs a replacement only if tasks are waiting.
      if (!shared_->waiting.empty()) Replace(now);
    } catch (const std::exception& no_memory_or_thread) {
      spdlog::warn("cannot supervise requests: {}", no_memory_or_thread.what());
    }
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
      shared_->changed.wait_until(
          lock, shared_->time.LookAgainAt(now + shared_->limits.hangs_after / 10));
    }
  }
}

}  // namespace thunderhead::base
