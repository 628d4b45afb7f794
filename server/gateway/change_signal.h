// Lets coroutines of one thread wait for a flag that other work on the same thread sets.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "gateway/awaitable.h"

namespace thunderhead::gateway {

class ChangeSignal {
 public:
  explicit ChangeSignal(const boost::asio::any_io_executor& executor)
      : never_(executor, boost::asio::steady_timer::time_point::max()) {}

  // Call after each change of a flag that may be awaited.
  void Notify() { never_.cancel(); }
  // Returns once `condition` holds; both must outlive the wait.
  boost::asio::awaitable<void> AwaitTrue(const bool& condition) {
    while (!condition) {
      boost::system::error_code woken;
      co_await never_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, woken));
    }
  }

 private:
  boost::asio::steady_timer never_;  // cancelled to wake those that wait
};

}  // namespace thunderhead::gateway
