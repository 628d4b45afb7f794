// Threads that open and read files for the gateway's own, which only waits for them: a storage that
// hangs holds up only those who want its files, and them no longer than a timeout. Knows no HTTP.
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
  // The timeout is by `time`, which must outlive this.
  FileThreads(std::chrono::milliseconds timeout, const base::TimeSource& time);
  FileThreads(const FileThreads&) = delete;
  FileThreads& operator=(const FileThreads&) = delete;

  // Runs `work` on one of the threads for the client `owner`; OK once it has returned.
  // DEADLINE_EXCEEDED if it does not in time, or RESOURCE_EXHAUSTED if too much waits, of this
  // client or in all. `work` must own all that it uses, as it may go on after that. Called on the
  // one thread of `executor`.
  boost::asio::awaitable<absl::Status> Run(const boost::asio::any_io_executor& executor,
                                           const std::string& owner, std::function<void()> work);

  // Ends all waits now, and each later one at once; on the executor's thread.
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
