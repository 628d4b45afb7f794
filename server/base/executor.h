// A few threads that run blocking work for callers that must not block, with a bounded queue.
// Owners of work get equal shares of the threads' time, and none can fill the queue or take every
// thread. Work that hangs, as with a storage that has gone, gives up its place to others after a
// while.
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
  // Called exactly once: with OK on one of the threads, or, if it is refused, with the reason on
  // the thread that called Submit or Stop, or on one of the executor's own.
  using Task = std::function<void(const absl::Status&)>;

  struct Limits {
    int threads = 4;
    // Tasks that wait: in all, and of one owner.
    std::size_t max_waiting = 1024;
    std::size_t max_waiting_each = 256;
    // A task that runs longer hangs: it does not count as one of `threads` any more.
    std::chrono::milliseconds hangs_after = std::chrono::seconds(20);
    // Tasks that hang, at most; with more, others wait.
    int max_hanging = 32;
    // Who has waited longer is refused with DEADLINE_EXCEEDED.
    std::chrono::milliseconds max_wait = std::chrono::seconds(60);
  };

  // `time` must outlive it.
  explicit Executor(const Limits& limits, const TimeSource& time = SteadyTime());
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // `owner` is who asked for it, an identity. Empty: the server itself, which may fill the queue
  // and take every thread.
  void Submit(const std::string& owner, Task task);
  // Tasks that hang now.
  int Hanging() const;

  // Waits for running tasks to end, for LooseThread::kPatience in all, and leaves behind those that
  // do not; waiting and later tasks are refused.
  void Stop();

 private:
  using Clock = TimeSource::Clock;

  struct Waiting {
    Task task;
    Clock::time_point since;
  };
  // A thread, and its task.
  struct Worker {
    std::optional<Clock::time_point> busy_since;
    std::string owner;  // of the task
    double charged_ms = 0.0;
    bool hangs = false;
  };
  // All that threads use, which may be left behind.
  struct Shared {
    Shared(const Limits& of, const TimeSource& by) : limits(of), time(by) {}

    const Limits limits;
    const TimeSource& time;
    std::mutex mutex;
    std::condition_variable changed;
    std::map<std::string, std::deque<Waiting>> waiting;  // by owner; no queue is empty
    std::size_t waiting_count = 0;
    std::map<std::string, int> running;  // by owner, without those that hang
    FairShare shares;
    double typical_ms = 1.0;  // of the last task
    std::list<std::shared_ptr<Worker>> workers;
    bool stopping = false;
  };

  // The next task for that worker, once there is one; nothing when it is to end.
  static std::optional<Task> WaitFor(Shared& shared, Worker& worker,
                                     std::unique_lock<std::mutex>& lock);
  static void Work(const std::shared_ptr<Shared>& shared, const std::shared_ptr<Worker>& worker);
  // The following need the mutex.
  // The next task of the owner who has had the least time, for that worker; nothing if none may
  // begin. Owners keep one thread free for others.
  static std::optional<Task> Take(Shared& shared, Worker& worker);
  static void End(Shared& shared, Worker& worker);
  static void Leave(Shared& shared, const std::string& owner);
  static std::vector<Task> TakeLate(Shared& shared, Clock::time_point now);
  // Notes who hangs, and begins threads in their place.
  void Replace(Clock::time_point now);
  void AddWorker();

  void Watch();

  const std::shared_ptr<Shared> shared_;
  std::list<LooseThread> threads_;  // with the mutex held
  std::thread watch_;
};

}  // namespace thunderhead::base
