// Threads that open and read files for the gateway's thread. A blocked storage delays only the
// clients that need its files, and each of these clients for at most a timeout. Independent of
// HTTP.
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

  // Runs `work` on one of the threads for the client `owner`. Returns OK when `work` has returned,
  // and DEADLINE_EXCEEDED after the timeout. Returns RESOURCE_EXHAUSTED if too much work is queued
  // for this client or in total. `work` must own everything that it uses, because it may continue
  // after an error. Run must be called on the thread of `executor`, which must have only one.
  boost::asio::awaitable<absl::Status> Run(const boost::asio::any_io_executor& executor,
                                           const std::string& owner, std::function<void()> work);

  // Ends all waits for results now, and each later wait at once. Must be called on the executor's
  // thread.
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
