// Work that fails by itself where there is no memory left for it, and takes nothing else with it.
#pragma once

#include <chrono>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "absl/status/status.h"
#include "base/error_details.h"

namespace thunderhead::base {

// An allocation that failed for a known reason, thrown where no status can be returned, as by the
// constructors of GL objects: the memory budget refuses it, or the device has none. Only
// OrOutOfMemory catches it.
class FailedAllocation : public std::bad_alloc {
 public:
  explicit FailedAllocation(absl::Status why) : why_(std::move(why)) {}
  const absl::Status& Why() const { return why_; }
  const char* what() const noexcept override { return "an allocation that failed"; }

 private:
  absl::Status why_;
};

inline absl::Status OutOfMemory() {
  return WithDetails(absl::ResourceExhaustedError(
                         "the server has not enough memory for that; ask for less, or try later"),
                     {.reason = "OUT_OF_MEMORY", .retry_after = std::chrono::seconds(30)});
}

// The status or StatusOr of `work`; RESOURCE_EXHAUSTED if an allocation in it failed.
template <typename Work>
auto OrOutOfMemory(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const FailedAllocation& failed) {
    return failed.Why();
  } catch (const std::bad_alloc&) {
    return OutOfMemory();
  } catch (const std::length_error&) {  // of containers: more than any memory
    return OutOfMemory();
  } catch (const std::system_error& failed) {
    // A thread that the system has no room for.
    if (failed.code() != std::errc::resource_unavailable_try_again) throw;
    return OutOfMemory();
  }
}

}  // namespace thunderhead::base
