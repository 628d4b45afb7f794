// Determines how much memory this process may use: the machine's memory, or the memory limit of the
// process's cgroup if that is lower.
#pragma once

#include <cstddef>
#include <string>

namespace thunderhead::base {

// Returns the number of bytes, or 0 if the system does not report it. `root` is the folder that
// contains /proc and /sys.
std::size_t MachineMemoryBytes(const std::string& root = "");

}  // namespace thunderhead::base
