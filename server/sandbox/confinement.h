// Removes from this process everything that it does not need to read bytes that it already has. It
// loses new files, sockets, processes, privileges, code, and memory and processor time beyond a
// limit. This cannot be undone. It uses Linux's seccomp and resource limits, and needs neither
// root nor namespaces.
#pragma once

#include <cstdint>

#include "absl/status/status.h"

namespace thunderhead::sandbox {

struct Allowance {
  std::uint64_t memory_bytes = 0;  // memory in addition to what the process has now
  std::uint32_t processor_s = 0;
};

// Returns FAILED_PRECONDITION if the kernel cannot do it. The process may then be partly confined.
absl::Status Confine(const Allowance& allowance);

}  // namespace thunderhead::sandbox
