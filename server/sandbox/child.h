// Child processes that read files, and the limit of those that cannot be ended.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <utility>

#include "absl/status/statusor.h"
#include "base/time_source.h"

namespace thunderhead::sandbox {

// The maximum number of abandoned children of this program. A child that does not end at once when
// it is killed is abandoned. It is still freeing much memory, or waits for a storage that does not
// answer.
inline constexpr std::size_t kMaxAbandonedChildren = 8;

// Collects the abandoned children that have ended meanwhile. Returns the number of the others.
std::size_t AbandonedChildren();

// The right to run a child process.
class ChildPlace {
 public:
  // Takes a place. While a child is abandoned, there are kMaxAbandonedChildren places for abandoned
  // and running children together. Otherwise the number of places is not limited, because a server
  // never runs that many readers at once. Returns UNAVAILABLE (STORAGE_HANGS) if no place is free.
  static absl::StatusOr<ChildPlace> Take();
  ChildPlace(ChildPlace&& other) noexcept : taken_(std::exchange(other.taken_, false)) {}
  ChildPlace& operator=(ChildPlace&&) = delete;
  ~ChildPlace();

  // Abandons `process`, which keeps the place until it has ended.
  void LeaveTo(pid_t process);

 private:
  ChildPlace() = default;

  bool taken_ = true;
};

// Sends SIGKILL to a process.
void KillProcess(pid_t process);

// A child process. The destructor kills the process and collects its exit status. If the process
// does not end at once, the destructor abandons it.
class Child {
 public:
  // `kill_process` replaces the signal in tests.
  Child(pid_t process, ChildPlace place, const base::TimeSource& time,
        void (*kill_process)(pid_t) = KillProcess)
      : process_(process), place_(std::move(place)), time_(time), kill_process_(kill_process) {}
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Returns the id of the process, or 0 once End has found that it ended.
  pid_t Process() const { return process_; }

  // Waits up to `patience` for the process to end. Returns the signal that ended the process, or 0
  // if it exited normally. Returns nothing if the process still runs.
  std::optional<int> End(std::chrono::milliseconds patience);

 private:
  pid_t process_;
  ChildPlace place_;
  const base::TimeSource& time_;
  void (*const kill_process_)(pid_t);
};

}  // namespace thunderhead::sandbox
