// Long computations in chunks on several threads, with a result that does not depend on how many:
// each chunk works into its own value, and the values are merged in the chunks' order.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace thunderhead::physics {

// How a long computation is run. `progress` is called with the share done, from one thread at a
// time.
struct WorkPlan {
  int threads = 1;
  std::function<void(double done)> progress = [](double) {};
};

// work(i) for i = 0 ... chunks - 1, in no particular order.
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
