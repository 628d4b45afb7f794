#include "reference/parallel.h"

#include <tbb/info.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace thunderhead::reference {

// Starts new threads, which inherit the caller's priority. The threads of oneTBB are shared by all
// callers and keep the priority of their first user. A low priority would then slow down the
// encoding of pictures.
void ParallelFor(int threads, int count, const std::function<void(int)>& work) {
  const int most = tbb::info::default_concurrency();
  const int used = std::min(threads > 0 ? std::min(threads, most) : most, count);
  // Tasks differ much in cost, so each thread takes one task at a time.
  std::atomic<int> next{0};
  std::mutex mutex;
  std::exception_ptr thrown;
  const auto take = [&] {
    try {
      for (int piece = next++; piece < count; piece = next++) work(piece);
    } catch (...) {
      next = count;
      const std::lock_guard lock(mutex);
      thrown = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (int i = 1; i < used; ++i) others.emplace_back(take);
    } catch (const std::system_error&) {
      // The system cannot create another thread, so the existing threads do all the work.
    }
    take();
  }
  if (thrown) std::rethrow_exception(thrown);
}

void ParallelForBlocks(int threads, std::size_t count, std::size_t block,
                       const std::function<void(std::size_t, std::size_t)>& work) {
  const std::size_t blocks = (count + block - 1) / block;
  ParallelFor(threads, static_cast<int>(blocks), [&](int i) {
    const std::size_t begin = static_cast<std::size_t>(i) * block;
    work(begin, std::min(begin + block, count));
  });
}

}  // namespace thunderhead::reference
