// Takes from this process all that it does not need to read bytes that it already has: new files,
// sockets, processes, privileges, code, and memory and processor time beyond a limit. There is no
// way back. Linux's seccomp and resource limits; no root, no namespace.
#pragma once

#include <cstdint>

#include "absl/status/status.h"

namespace thunderhead::sandbox {

struct Allowance {
  std::uint64_t memory_bytes = 0;  // beyond what the process has now
  std::uint32_t processor_s = 0;
};

// FAILED_PRECONDITION if the kernel cannot do it; the process is then not confined, or half.
absl::Status Confine(const Allowance& allowance);

}  // namespace thunderhead::sandbox
