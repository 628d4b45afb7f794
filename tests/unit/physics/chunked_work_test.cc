#include "physics/chunked_work.h"

#include <gtest/gtest.h>

#include <atomic>
#include <new>

namespace thunderhead::physics {
namespace {

TEST(ChunkedWork, CallsEachChunkOnce) {
  std::vector<std::atomic<int>> calls(100);
  double done = 0.0;
  ForEachChunk(100, {.threads = 4, .progress = [&done](double share) { done = share; }},
               [&](int chunk) { ++calls[static_cast<std::size_t>(chunk)]; });
  for (const std::atomic<int>& count : calls) EXPECT_EQ(count, 1);
  EXPECT_EQ(done, 1.0);
}

// Without a handler in each thread, such an exception would end the process.
TEST(ChunkedWork, AnExceptionOfAThreadReachesTheCaller) {
  std::atomic<int> calls{0};
  const auto work = [&](int) {
    ++calls;
    throw std::bad_alloc();
  };
  EXPECT_THROW(ForEachChunk(1000, {.threads = 4}, work), std::bad_alloc);
  EXPECT_LE(calls, 4);
}

}  // namespace
}  // namespace thunderhead::physics
