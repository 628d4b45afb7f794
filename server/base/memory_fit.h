// Checks that arrays whose sizes a file specifies fit into memory, before they are allocated.
// Without the check, the kernel might grant an allocation larger than the memory, and kill the
// process when the process writes to it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::base {

// Returns the product of `lengths`. Returns RESOURCE_EXHAUSTED if that many values of `bytes_each`
// bytes exceed the machine's memory or the process's limit. `what` begins the message, e.g.
// "wrfout_d01: QCLOUD".
absl::StatusOr<std::size_t> CountThatFits(const std::string& what,
                                          const std::vector<std::size_t>& lengths,
                                          std::size_t bytes_each);

}  // namespace thunderhead::base
