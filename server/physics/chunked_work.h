// Long computations in chunks on several threads. The result does not depend on the number of
// threads: each chunk writes its own value, and the values are merged in the order of the chunks.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace thunderhead::physics {

// Settings of a long computation. `progress` receives the finished share and is called from one
// thread at a time.
struct WorkPlan {
  int threads = 1;
  std::function<void(double done)> progress = [](double) {};
};

// Calls work(i) for i = 0 ... chunks - 1, in no particular order. If a call throws, ForEachChunk
// starts no further calls, and throws the exception again when the running calls have returned. If
// a thread cannot be started, the other threads do its work.
template <typename Work>
void ForEachChunk(int chunks, const WorkPlan& plan, const Work& work) {
  std::atomic<int> next = 0;
  std::mutex mutex;
  int finished = 0;
  std::exception_ptr thrown;
  const auto run = [&] {
    try {
      for (int chunk = next++; chunk < chunks; chunk = next++) {
        work(chunk);
        const std::lock_guard lock(mutex);
        plan.progress(static_cast<double>(++finished) / chunks);
      }
    } catch (...) {
      next = chunks;
      const std::lock_guard lock(mutex);
      thrown = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    try {
      for (int i = 1; i < std::min(plan.threads, chunks); ++i) threads.emplace_back(run);
    } catch (const std::system_error&) {
      // The system cannot start another thread, so the existing threads do all the work.
    }
    run();
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace thunderhead::physics
