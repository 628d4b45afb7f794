// The kernel's information about a process, which distinguishes one that works from one that waits
// for a storage.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>

namespace thunderhead::sandbox {

struct ProcessState {
  bool waits_for_storage = false;        // at this moment, and cannot be interrupted
  std::uint64_t pages_from_storage = 0;  // waited for so far (major page faults)
};

// Reads /proc/PID/stat (proc(5)). Returns nothing if there is no such process, or no /proc.
std::optional<ProcessState> StateOf(pid_t process);

// Decides at each call whether the storage explains why a process is silent.
class StorageWatch {
 public:
  explicit StorageWatch(pid_t process) : process_(process) {}

  // Returns whether the process waits for a storage now, or has got pages from one since the last
  // call.
  bool ExplainsSilence();

 private:
  const pid_t process_;
  std::uint64_t pages_before_ = 0;
};

}  // namespace thunderhead::sandbox
