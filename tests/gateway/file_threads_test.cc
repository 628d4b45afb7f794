#include "gateway/file_threads.h"

#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <utility>

namespace thunderhead::gateway::test {
namespace {

namespace net = boost::asio;

TEST(FileThreadsTest, AWholeClassMayHaveOneAddress) {
  net::io_context io;
  FileThreads threads(std::chrono::hours(24), base::SteadyTime());
  std::promise<void> go;
  const std::shared_future<void> gone = go.get_future().share();
  int served = 0;
  const auto ask = [&]() -> net::awaitable<void> {
    std::function<void()> work = [gone] { gone.wait(); };
    const std::string owner = "192.0.2.1";
    const absl::Status done = co_await threads.Run(io.get_executor(), owner, std::move(work));
    if (done.ok()) ++served;
  };
  for (int i = 0; i < 512; ++i) net::co_spawn(io, ask(), net::detached);
  io.poll();
  go.set_value();
  io.run();
  EXPECT_EQ(served, 512);
}

}  // namespace
}  // namespace thunderhead::gateway::test
