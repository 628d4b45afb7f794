// Threads that open and read files for the gateway's thread. A hanging storage delays only the
// clients that need its files, and each of them for at most a timeout. It is independent of HTTP.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <unordered_set>

#include "absl/status/status.h"
#include "base/executor.h"
#include "base/time_source.h"
#include "gateway/awaitable.h"

namespace thunderhead::gateway {

class FileThreads {
 public:
  // `time` measures the timeout and must outlive this object.
  FileThreads(std::chrono::milliseconds timeout, const base::TimeSource& time);
  FileThreads(const FileThreads&) = delete;
  FileThreads& operator=(const FileThreads&) = delete;

  // Runs `work` on one of the threads for the client `owner`, and returns OK when it has returned.
  // Returns DEADLINE_EXCEEDED after the timeout. Returns RESOURCE_EXHAUSTED if too much work of
  // this client, or in total, is queued. `work` must own everything that it uses, because it may
  // continue after an error. The function must be called on the only thread of `executor`.
  boost::asio::awaitable<absl::Status> Run(const boost::asio::any_io_executor& executor,
                                           const std::string& owner, std::function<void()> work);

  // Ends all waits now, and each later one at once. It must be called on the executor's thread.
  void StopWaiting();

 private:
  struct Wait;

  const std::chrono::milliseconds timeout_;
  const base::TimeSource& time_;
  std::unordered_set<Wait*> waits_;
  bool stopped_ = false;
  base::Executor threads_;
};

}  // namespace thunderhead::gateway
