#include "base/timed_calls.h"

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/guarded.h"

namespace thunderhead::base {
namespace {

constexpr std::chrono::seconds kRetryAfter{10};

absl::Status NoAnswer(const std::string& storage) {
  return WithDetails(
      absl::DeadlineExceededError(
          absl::StrCat(storage, ": its storage does not answer; try again later")),
      {.reason = kStorageHangs, .metadata = {{"file", storage}}, .retry_after = kRetryAfter});
}

}  // namespace

TimedCalls::~TimedCalls() {
  for (auto& [storage, call] : hanging_) call.thread.LetGo();
}

absl::Status TimedCalls::Run(const std::string& storage, const std::function<void()>& call) {
  {
    const std::lock_guard lock(mutex_);
    if (Hangs(storage)) return NoAnswer(storage);
  }
  // `since` is read before the call begins, so that the timeout includes the start of the thread.
  const auto since = time_.Now();
  std::optional<LooseThread> thread;
  try {
    thread.emplace(absl::StrCat("a call to ", storage), call, time_);
  } catch (const std::system_error&) {
    // The system cannot start another thread.
    return OutOfMemory();
  }
  if (thread->EndsBy(since + patience_)) {
    thread->Rethrow();
    return absl::OkStatus();
  }
  const std::lock_guard lock(mutex_);
  hanging_.emplace(storage, Hanging{*std::move(thread), since});
  return NoAnswer(storage);
}

double TimedCalls::HangingSeconds() {
  const std::lock_guard lock(mutex_);
  const auto now = time_.Now();
  TimeSource::Clock::duration longest{};
  for (const auto& [storage, call] : hanging_) {
    if (!call.thread.HasEnded()) longest = std::max(longest, now - call.since);
  }
  return std::chrono::duration<double>(longest).count();
}

bool TimedCalls::Hangs(const std::string& storage) {
  const auto [begin, end] = hanging_.equal_range(storage);
  for (auto call = begin; call != end;) {
    if (!call->second.thread.HasEnded()) return true;
    call = hanging_.erase(call);
  }
  return false;
}

}  // namespace thunderhead::base
