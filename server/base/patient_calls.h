// Calls to a storage that may hang: each runs on a thread of its own, and its caller waits for it
// no longer than its patience.
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

// The reason in details of an error.
inline constexpr char kStorageHangs[] = "STORAGE_HANGS";

class PatientCalls {
 public:
  // `time` must outlive this.
  explicit PatientCalls(std::chrono::milliseconds patience, const TimeSource& time = SteadyTime())
      : patience_(patience), time_(time) {}
  // Leaves behind what hangs.
  ~PatientCalls();
  PatientCalls(const PatientCalls&) = delete;
  PatientCalls& operator=(const PatientCalls&) = delete;

  // Runs `call`, which must own all that it uses, as it may outlive this. DEADLINE_EXCEEDED with
  // the reason STORAGE_HANGS and a time to try again if it does not return in time, and at once
  // while an earlier call for the same storage does not. `storage` names it in the message, such as
  // a folder. What `call` throws is thrown here. From any thread.
  absl::Status Run(const std::string& storage, const std::function<void()>& call);

  // The same for a call that gives a Status or a StatusOr: what it gave, or why it gave nothing.
  template <typename Call>
  std::invoke_result_t<Call> Ask(const std::string& storage, Call call) {
    const auto answer = std::make_shared<std::optional<std::invoke_result_t<Call>>>();
    THUNDERHEAD_RETURN_IF_ERROR(
        Run(storage, [answer, call = std::move(call)] { answer->emplace(call()); }));
    return *std::move(*answer);
  }

  // Since the oldest call that hangs began; 0 if none hangs.
  double HangingSeconds();

 private:
  // A call that did not return in time.
  struct Hanging {
    LooseThread thread;
    TimeSource::Clock::time_point since;
  };

  // With the mutex held; lets go of the calls that have returned.
  bool Hangs(const std::string& storage);

  const std::chrono::milliseconds patience_;
  const TimeSource& time_;
  std::mutex mutex_;
  std::multimap<std::string, Hanging> hanging_;  // by storage
};

}  // namespace thunderhead::base
