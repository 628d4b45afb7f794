// Confines this process with all its threads, so that it can only process bytes that it already has
// in memory, and use pipes that are already open. The process can no longer open files or sockets,
// start processes, gain privileges or load code, and its memory and processor time are limited.
// This cannot be undone. The implementation uses Linux's seccomp and resource limits, and needs
// neither root rights nor namespaces.
#pragma once

#include <cstdint>

#include "absl/status/status.h"

namespace thunderhead::sandbox {

struct Allowance {
  std::uint64_t memory_bytes = 0;  // limit of memory in addition to the memory that the process has
                                   // now
  std::uint32_t processor_s = 0;
};

// Returns FAILED_PRECONDITION if the kernel does not support the confinement. The process may then
// be partly confined.
absl::Status Confine(const Allowance& allowance);

}  // namespace thunderhead::sandbox
