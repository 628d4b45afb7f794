// A signal for coroutines that wait for a flag. The flag is set by other work on the same thread.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "gateway/awaitable.h"

namespace thunderhead::gateway {

class ChangeSignal {
 public:
  explicit ChangeSignal(const boost::asio::any_io_executor& executor)
      : never_(executor, boost::asio::steady_timer::time_point::max()) {}

  // Wakes the waiting coroutines. Call it after each change of an awaited flag.
  void Notify() { never_.cancel(); }
  // Returns when `condition` is true. The condition and this object must outlive the wait.
  boost::asio::awaitable<void> AwaitTrue(const bool& condition) {
    while (!condition) {
      boost::system::error_code woken;
      co_await never_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, woken));
    }
  }

 private:
  boost::asio::steady_timer never_;  // cancelled to wake the waiting coroutines
};

}  // namespace thunderhead::gateway
