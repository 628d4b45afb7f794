// How much memory this process may use: the machine's, or less where its cgroup says so.
#pragma once

#include <cstddef>
#include <string>

namespace thunderhead::base {

// Bytes; 0 if the system does not tell. `root` is the folder that /proc and /sys are in.
std::size_t MachineMemoryBytes(const std::string& root = "");

}  // namespace thunderhead::base
