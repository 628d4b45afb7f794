#include "gateway/file_threads.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <mutex>
#include <optional>
#include <utility>

namespace thunderhead::gateway {
namespace {

namespace net = boost::asio;
using std::chrono::milliseconds;

// Work on a file counts as hanging after this time. Another thread then replaces the thread that
// does it.
constexpr milliseconds kHangsAfter{1000};

base::Executor::Limits LimitsFor(milliseconds timeout) {
  base::Executor::Limits limits;
  limits.threads = 4;
  limits.max_waiting = 1024;
  // The limit per client equals the total limit: one address may stand for a whole school class,
  // and the threads are shared fairly anyway.
  limits.max_waiting_each = limits.max_waiting;
  limits.hangs_after = std::min(kHangsAfter, timeout);
  limits.max_hanging = 16;
  limits.max_wait = timeout;
  return limits;
}

}  // namespace

// A coroutine's wait for work on a thread. The work may outlive the wait, and even the executor.
struct FileThreads::Wait {
  std::mutex mutex;
  net::steady_timer* timer = nullptr;  // null once no coroutine waits
  std::optional<absl::Status> outcome;

  // Reports the outcome; it may be called on any thread.
  static void Tell(const std::shared_ptr<Wait>& wait, const absl::Status& status) {
    const std::lock_guard lock(wait->mutex);
    wait->outcome = status;
    if (wait->timer == nullptr) return;
    net::post(wait->timer->get_executor(), [wait] {
      // Only the executor's thread, which runs this code, ends the wait, so the check needs no
      // lock.
      if (wait->timer != nullptr) wait->timer->cancel();
    });
  }

  bool HasEnded() {
    const std::lock_guard lock(mutex);
    return outcome.has_value();
  }

  absl::Status End() {
    const std::lock_guard lock(mutex);
    timer = nullptr;
    return outcome.value_or(absl::DeadlineExceededError("the file's storage does not answer"));
  }
};

FileThreads::FileThreads(milliseconds timeout, const base::TimeSource& time)
    : timeout_(timeout), time_(time), threads_(LimitsFor(timeout), time) {}

net::awaitable<absl::Status> FileThreads::Run(const net::any_io_executor& executor,
                                              const std::string& owner,
                                              std::function<void()> work) {
  if (stopped_) co_return absl::CancelledError("the gateway is going away");
  net::steady_timer timer(executor);
  const auto wait = std::make_shared<Wait>();
  wait->timer = &timer;
  threads_.Submit(owner, [wait, work = std::move(work)](const absl::Status& status) {
    if (status.ok()) work();
    Wait::Tell(wait, status);
  });
  waits_.insert(wait.get());
  const auto deadline = time_.Now() + timeout_;
  boost::system::error_code woken;
  // A timer that has already fired cannot be cancelled, so the loop does not rely on the outcome of
  // the timer alone.
  while (!wait->HasEnded() && !stopped_ && time_.Now() < deadline) {
    timer.expires_at(time_.LookAgainAt(deadline));
    co_await timer.async_wait(net::redirect_error(net::use_awaitable, woken));
  }
  waits_.erase(wait.get());
  const absl::Status outcome = wait->End();
  co_return outcome;
}

void FileThreads::StopWaiting() {
  stopped_ = true;
  for (Wait* const wait : waits_) wait->timer->cancel();
}

}  // namespace thunderhead::gateway
