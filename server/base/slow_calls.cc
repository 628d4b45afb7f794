#include "base/slow_calls.h"

#include <csignal>
#include <utility>

#include "absl/strings/str_format.h"
#include "spdlog/spdlog.h"

namespace thunderhead::base {
namespace {

constexpr std::chrono::seconds kPatience{10};

double Seconds(SlowCalls::Clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

SlowCalls::SlowCalls(std::chrono::milliseconds patience,
                     std::function<void(const std::string&)> say, const TimeSource& time)
    : patience_(patience), say_(std::move(say)), time_(time) {
  // All signals are blocked in the new thread, because other threads wait for them.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::jthread([this](const std::stop_token& stop) { Watch(stop); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

SlowCalls& SlowCalls::OfProcess() {
  // The instance is never destroyed, because a call that hangs outlives everything else.
  static SlowCalls* const process =
      new SlowCalls(kPatience, [](const std::string& what) { spdlog::warn("{}", what); });
  return *process;
}

std::list<SlowCalls::Begun>::iterator SlowCalls::Begin(std::string path) {
  const std::lock_guard lock(mutex_);
  return calls_.insert(calls_.end(), {std::move(path), time_.Now(), patience_});
}

void SlowCalls::End(std::list<Begun>::iterator call) {
  const std::lock_guard lock(mutex_);
  if (call->say_after > patience_) {
    say_(absl::StrFormat("%s: answered after %.1f s", call->path, Seconds(time_.Now() - call->at)));
  }
  calls_.erase(call);
}

void SlowCalls::Watch(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const auto now = time_.Now();
    for (Begun& call : calls_) {
      if (now - call.at < call.say_after) continue;
      say_(
          absl::StrFormat("%s: has not answered for %.1f s; its storage is slow or hangs, or "
                          "there is much to read",
                          call.path, Seconds(now - call.at)));
      call.say_after *= 2;
    }
    stopped_.wait_until(lock, stop, time_.LookAgainAt(now + patience_ / 4),
                        [&] { return stop.stop_requested(); });
  }
}

}  // namespace thunderhead::base
