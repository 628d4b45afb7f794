// A few threads that run blocking work for callers that must not block, with a bounded queue. Work
// that hangs, as with a storage that has gone, gives up its place to others after a while.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "absl/status/status.h"
#include "base/loose_thread.h"

namespace thunderhead::base {

class Executor {
 public:
  // Called exactly once: with OK on one of the threads, or, if it is refused, with the reason on
  // the thread that called Submit or Stop, or on one of the executor's own.
  using Task = std::function<void(const absl::Status&)>;

  struct Limits {
    int threads = 4;
    std::size_t max_waiting = 256;
    // A task that runs longer hangs: it does not count as one of `threads` any more.
    std::chrono::milliseconds hangs_after = std::chrono::seconds(20);
    // Tasks that hang, at most; with more, others wait.
    int max_hanging = 32;
    // Who has waited longer is refused with DEADLINE_EXCEEDED.
    std::chrono::milliseconds max_wait = std::chrono::seconds(60);
  };

  explicit Executor(const Limits& limits);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  void Submit(Task task);
  // Tasks that hang now.
  int Hanging() const;

  // Waits for running tasks to end, but leaves behind those that hang; waiting and later tasks are
  // refused.
  void Stop();

 private:
  using Clock = std::chrono::steady_clock;

  struct Waiting {
    Task task;
    Clock::time_point since;
  };
  // A thread, and its task.
  struct Worker {
    std::optional<Clock::time_point> busy_since;
    bool hangs = false;
  };
  // All that threads use, which may be left behind.
  struct Shared {
    explicit Shared(const Limits& of) : limits(of) {}

    const Limits limits;
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Waiting> waiting;
    std::list<std::shared_ptr<Worker>> workers;
    bool stopping = false;
  };

  static void Work(const std::shared_ptr<Shared>& shared, const std::shared_ptr<Worker>& worker);
  void Watch();
  // With the mutex held: notes who hangs, and begins threads in their place.
  void Replace(Clock::time_point now);
  void AddWorker();

  const std::shared_ptr<Shared> shared_;
  std::list<LooseThread> threads_;  // with the mutex held
  std::thread watch_;
};

}  // namespace thunderhead::base
