// Calls to a storage that may hang: each runs on a thread of its own, and its caller waits for it
// no longer than its patience.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "base/loose_thread.h"

namespace thunderhead::base {

class PatientCalls {
 public:
  explicit PatientCalls(std::chrono::milliseconds patience) : patience_(patience) {}
  PatientCalls(const PatientCalls&) = delete;
  PatientCalls& operator=(const PatientCalls&) = delete;

  // Runs `call`, which must own all that it uses, as it may outlive this. DEADLINE_EXCEEDED with
  // the reason STORAGE_HANGS and a time to try again if it does not return in time, and at once
  // while an earlier call for the same storage does not. `storage` names it in the message, such as
  // a folder. From any thread.
  absl::Status Run(const std::string& storage, const std::function<void()>& call);

 private:
  // With the mutex held; lets go of the calls that have returned.
  bool Hangs(const std::string& storage);

  const std::chrono::milliseconds patience_;
  std::mutex mutex_;
  std::multimap<std::string, LooseThread> hanging_;  // by storage
};

}  // namespace thunderhead::base
