// Work whose exceptions become statuses, so that one request that fails takes nothing else with it.
#pragma once

#include <chrono>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "absl/status/status.h"
#include "base/error_details.h"

namespace thunderhead::base {

// An allocation that failed for a known reason, thrown where no status can be returned, as by the
// constructors of GL objects: the memory budget refuses it, or the device has none. Only Guarded
// catches it.
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

// Returns INTERNAL for an exception that no code expects, and logs what it says. A caller is told
// only that the server failed, because the text may name files.
absl::Status UnexpectedFailure(const char* what);

// Returns the status or StatusOr of `work`: RESOURCE_EXHAUSTED if an allocation or a thread could
// not be had, INTERNAL for any other exception, also those by which protobuf reports a failed
// precondition.
template <typename Work>
auto Guarded(const Work& work) -> decltype(work()) {
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
    if (failed.code() == std::errc::resource_unavailable_try_again) return OutOfMemory();
    return UnexpectedFailure(failed.what());
  } catch (const std::exception& failed) {
    return UnexpectedFailure(failed.what());
  } catch (...) {
    return UnexpectedFailure("an exception of an unknown type");
  }
}

}  // namespace thunderhead::base
