// What the kernel says of a process, to tell one that works from one that waits for a storage.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>

namespace thunderhead::sandbox {

struct ProcessState {
  bool waits_for_storage = false;        // at this moment, and cannot be interrupted
  std::uint64_t pages_from_storage = 0;  // that it has waited for so far (major page faults)
};

// Reads /proc/PID/stat (proc(5)). Nothing if there is no such process, or no /proc.
std::optional<ProcessState> StateOf(pid_t process);

// Judges, each time it is asked, whether the storage explains that a process is silent.
class StorageWatch {
 public:
  explicit StorageWatch(pid_t process) : process_(process) {}

  // True if the process waits for a storage now, or has got pages from one since the last call.
  bool ExplainsSilence();

 private:
  const pid_t process_;
  std::uint64_t pages_before_ = 0;
};

}  // namespace thunderhead::sandbox
