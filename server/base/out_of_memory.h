// Work that fails by itself where there is no memory left for it, and takes nothing else with it.
#pragma once

#include <chrono>
#include <new>
#include <stdexcept>

#include "absl/status/status.h"
#include "base/error_details.h"

namespace thunderhead::base {

inline absl::Status OutOfMemory() {
  return WithDetails(absl::ResourceExhaustedError(
                         "the server has not enough memory for that; ask for less, or try later"),
                     {.reason = "OUT_OF_MEMORY", .retry_after = std::chrono::seconds(30)});
}

// What `work` returns, a status or StatusOr, or RESOURCE_EXHAUSTED if an allocation in it failed.
template <typename Work>
auto OrOutOfMemory(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return OutOfMemory();
  } catch (const std::length_error&) {  // of containers: more than any memory
    return OutOfMemory();
  }
}

}  // namespace thunderhead::base
