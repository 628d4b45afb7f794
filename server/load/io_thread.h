// A thread that runs Asio's handlers.
#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <thread>

namespace thunderhead::load {

class IoThread {
 public:
  // Stops the thread and drops handlers that have not run.
  ~IoThread() {
    io_.stop();
    thread_.join();
  }

  boost::asio::io_context& io() { return io_; }

 private:
  boost::asio::io_context io_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{
      io_.get_executor()};
  std::thread thread_{[this] { io_.run(); }};
};

}  // namespace thunderhead::load
