// A few threads that run blocking work for callers that must not block, with a bounded queue.
// Owners of work get equal shares of the threads' time. No client can fill the queue or occupy
// every thread. When a task hangs, for example because its storage is unreachable, a new thread
// replaces the task's thread after Limits::hangs_after.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "base/fair_share.h"
#include "base/loose_thread.h"
#include "base/time_source.h"

namespace thunderhead::base {

class Executor {
 public:
  // A task is called exactly once. It is called with OK on one of the threads. If the task is
  // refused, it is called with the reason on the thread that called Submit or Stop, or on the
  // executor's watch thread.
  using Task = std::function<void(const absl::Status&)>;

  struct Limits {
    int threads = 4;
    // Maximum number of waiting tasks, in total and for each owner.
    std::size_t max_waiting = 1024;
    std::size_t max_waiting_each = 256;
    // A task that runs longer than this counts as hanging, and its thread no longer counts as one
    // of `threads`.
    std::chrono::milliseconds hangs_after = std::chrono::seconds(20);
    // Maximum number of hanging tasks. When it is reached, hanging threads are not replaced.
    int max_hanging = 32;
    // A task that has waited longer than this is refused with DEADLINE_EXCEEDED.
    std::chrono::milliseconds max_wait = std::chrono::seconds(60);
  };

  // `time` must outlive the executor.
  explicit Executor(const Limits& limits, const TimeSource& time = SteadyTime());
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // Queues a task. `owner` is the identity that requested the task. An empty owner means the server
  // itself, which may fill the queue and occupy every thread.
  void Submit(const std::string& owner, Task task);
  // Returns how many tasks hang now.
  int Hanging() const;

  // Refuses waiting and later tasks. Then waits for the running tasks to end, for
  // LooseThread::kPatience in total, and abandons threads whose tasks have not ended by then.
  void Stop();

 private:
  using Clock = TimeSource::Clock;

  struct Waiting {
    Task task;
    Clock::time_point since;
  };
  // The state of a thread of the executor and of the task that it runs.
  struct Worker {
    std::optional<Clock::time_point> busy_since;
    std::string owner;  // the task's owner
    double charged_ms = 0.0;
    bool hangs = false;
  };
  // The state that the threads use. It outlives the executor if a thread is abandoned.
  struct Shared {
    Shared(const Limits& of, const TimeSource& by) : limits(of), time(by) {}

    const Limits limits;
    const TimeSource& time;
    std::mutex mutex;
    std::condition_variable changed;
    std::map<std::string, std::deque<Waiting>> waiting;  // queues by owner; an empty queue is
                                                         // removed
    std::size_t waiting_count = 0;
    std::map<std::string, int> running;  // number of running tasks by owner, without hanging tasks
    FairShare shares;
    double typical_ms = 1.0;  // duration in ms of the last task that did not hang
    std::list<std::shared_ptr<Worker>> workers;
    bool stopping = false;
  };

  // Waits for the next task for the worker. Returns nothing when the worker must exit.
  static std::optional<Task> WaitFor(Shared& shared, Worker& worker,
                                     std::unique_lock<std::mutex>& lock);
  static void Work(const std::shared_ptr<Shared>& shared, const std::shared_ptr<Worker>& worker);
  // The functions below, except Watch, require the mutex.
  //
  // Takes the next task for the worker, from the owner that has used the least time. Returns
  // nothing if no task may start. Every owner except the server itself must leave one thread free
  // for others.
  static std::optional<Task> Take(Shared& shared, Worker& worker);
  static void End(Shared& shared, Worker& worker);
  static void Leave(Shared& shared, const std::string& owner);
  static std::vector<Task> TakeLate(Shared& shared, Clock::time_point now);
  // Marks workers that hang, and starts threads that replace them.
  void Replace(Clock::time_point now);
  void AddWorker();

  void Watch();

  const std::shared_ptr<Shared> shared_;
  std::list<LooseThread> threads_;  // access requires Shared::mutex
  std::thread watch_;
};

}  // namespace thunderhead::base
