#include "reference/parallel.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace thunderhead::reference {

#ifdef __SANITIZE_THREAD__

// ThreadSanitizer cannot see the synchronisation inside oneTBB as distributions ship it, and
// reports races in its data. With plain threads it checks only this program's data.
void ParallelFor(int threads, int count, const std::function<void(int)>& work) {
  const int most = tbb::info::default_concurrency();
  std::atomic<int> next{0};
  std::vector<std::jthread> pool;
  for (int i = 0; i < (threads > 0 ? std::min(threads, most) : most); ++i) {
    pool.emplace_back([&] {
      for (int piece = next++; piece < count; piece = next++) work(piece);
    });
  }
}

#else

void ParallelFor(int threads, int count, const std::function<void(int)>& work) {
  const int most = tbb::info::default_concurrency();
  tbb::task_arena arena(threads > 0 ? std::min(threads, most) : most);
  const auto run = [&](const tbb::blocked_range<int>& range) {
    for (int i = range.begin(); i != range.end(); ++i) work(i);
  };
  // Tasks differ much in cost, so threads take one at a time.
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, count, 1), run, tbb::simple_partitioner());
  });
}

#endif

}  // namespace thunderhead::reference
