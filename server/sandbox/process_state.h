// The kernel's information about a process. It shows whether the process is waiting for a storage.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>

namespace thunderhead::sandbox {

struct ProcessState {
  bool waits_for_storage = false;        // true if the process is now in an uninterruptible wait
                                         // (state D)
  std::uint64_t pages_from_storage = 0;  // number of pages read from a storage so far (major page
                                         // faults)
};

// Reads /proc/PID/stat (proc(5)). Returns nothing if there is no such process, or no /proc.
std::optional<ProcessState> StateOf(pid_t process);

// Decides whether a slow storage explains why a process has sent nothing.
class StorageWatch {
 public:
  explicit StorageWatch(pid_t process) : process_(process) {}

  // Returns whether the process is waiting for a storage now, or has received pages from a storage
  // since the last call.
  bool ExplainsSilence();

 private:
  const pid_t process_;
  std::uint64_t pages_before_ = 0;
};

}  // namespace thunderhead::sandbox
