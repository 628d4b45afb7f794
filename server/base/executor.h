// A few threads that run blocking work for callers that must not block, with a bounded queue.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/status/status.h"

namespace thunderhead::base {

class Executor {
 public:
  // Called exactly once: with OK on one of the threads, or, if it is refused, with the reason on
  // the thread that called Submit or Stop.
  using Task = std::function<void(const absl::Status&)>;

  Executor(int threads, std::size_t max_waiting);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  void Submit(Task task);

  // Waits for running tasks to end; waiting and later tasks are refused.
  void Stop();

 private:
  void Run();

  const std::size_t max_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> waiting_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace thunderhead::base
