// Checks that the arrays that a file announces fit into memory, before they are allocated. The
// kernel may promise more memory than there is, and kill the process when it touches that memory.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace thunderhead::base {

// Returns the product of `lengths`. Returns RESOURCE_EXHAUSTED if that many values of `bytes_each`
// exceed this machine's memory or this process's limit. `what` begins the message, e.g.
// "wrfout_d01: QCLOUD".
absl::StatusOr<std::size_t> CountThatFits(const std::string& what,
                                          const std::vector<std::size_t>& lengths,
                                          std::size_t bytes_each);

}  // namespace thunderhead::base
