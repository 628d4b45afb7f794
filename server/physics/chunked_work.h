// Long computations in chunks on several threads. The result does not depend on the number of
// threads: each chunk writes its own value, and the values are merged in the order of the chunks.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace thunderhead::physics {

// Settings of a long computation. `progress` receives the finished share and is called from one
// thread at a time.
struct WorkPlan {
  int threads = 1;
  std::function<void(double done)> progress = [](double) {};
};

// Calls work(i) for i = 0 ... chunks - 1, in no particular order.
template <typename Work>
void ForEachChunk(int chunks, const WorkPlan& plan, const Work& work) {
  std::atomic<int> next = 0;
  std::mutex mutex;
  int finished = 0;
  const auto run = [&] {
    for (int chunk = next++; chunk < chunks; chunk = next++) {
      work(chunk);
      const std::lock_guard lock(mutex);
      plan.progress(static_cast<double>(++finished) / chunks);
    }
  };
  std::vector<std::jthread> threads;
  for (int i = 1; i < std::min(plan.threads, chunks); ++i) threads.emplace_back(run);
  run();
}

}  // namespace thunderhead::physics
