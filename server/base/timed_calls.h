// Calls, with a timeout, functions that use a storage which may hang. Each call runs on a separate
// thread, and its caller waits no longer than the timeout.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "absl/status/status.h"
#include "base/loose_thread.h"
#include "base/status.h"
#include "base/time_source.h"

namespace thunderhead::base {

// The reason in the details of the error for a call that timed out.
inline constexpr char kStorageHangs[] = "STORAGE_HANGS";

class TimedCalls {
 public:
  // `time` must outlive this object.
  explicit TimedCalls(std::chrono::milliseconds patience, const TimeSource& time = SteadyTime())
      : patience_(patience), time_(time) {}
  // Abandons the threads of calls that hang.
  ~TimedCalls();
  TimedCalls(const TimedCalls&) = delete;
  TimedCalls& operator=(const TimedCalls&) = delete;

  // Runs `call`, which must own everything it uses, because it may outlive this object. If `call`
  // does not return within the timeout, returns DEADLINE_EXCEEDED with the reason STORAGE_HANGS and
  // a retry delay. While an earlier call for the same storage hangs, returns that error at once.
  // Returns RESOURCE_EXHAUSTED if the system cannot start a thread for the call. `storage`
  // identifies the storage, for example by a folder, and appears in the error message. Rethrows
  // what `call` throws. Safe from any thread.
  absl::Status Run(const std::string& storage, const std::function<void()>& call);

  // Does the same for a call that returns a Status or a StatusOr. Returns the call's result, or the
  // error of Run if the call timed out.
  template <typename Call>
  std::invoke_result_t<Call> Ask(const std::string& storage, Call call) {
    const auto answer = std::make_shared<std::optional<std::invoke_result_t<Call>>>();
    THUNDERHEAD_RETURN_IF_ERROR(
        Run(storage, [answer, call = std::move(call)] { answer->emplace(call()); }));
    return *std::move(*answer);
  }

  // Returns the seconds since the oldest hanging call began, or 0 if none hangs.
  double HangingSeconds();

 private:
  // A call that did not return in time.
  struct Hanging {
    LooseThread thread;
    TimeSource::Clock::time_point since;
  };

  // Returns whether a call for the storage hangs. Joins the calls that have returned. Requires the
  // mutex.
  bool Hangs(const std::string& storage);

  const std::chrono::milliseconds patience_;
  const TimeSource& time_;
  std::mutex mutex_;
  std::multimap<std::string, Hanging> hanging_;  // hanging calls by the name of their storage
};

}  // namespace thunderhead::base
