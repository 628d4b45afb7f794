// Converts exceptions to statuses, so that one request that fails does not affect others.
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

// The exception for a failed allocation whose reason is known: the memory budget refused it, or the
// device has no memory left. It is thrown by code that cannot return a status, for example by
// constructors of GL objects. Only Guarded catches it.
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

// Logs the text `what` of an unexpected exception and returns INTERNAL. The returned message says
// only that the server failed, because `what` may contain file names.
absl::Status UnexpectedFailure(const char* what);

// Returns the status or StatusOr of `work`. Returns RESOURCE_EXHAUSTED if an allocation or a thread
// was not available. Returns INTERNAL for any other exception, including those by which protobuf
// reports a failed precondition.
template <typename Work>
auto Guarded(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const FailedAllocation& failed) {
    return failed.Why();
  } catch (const std::bad_alloc&) {
    return OutOfMemory();
  } catch (const std::length_error&) {  // a container larger than any memory
    return OutOfMemory();
  } catch (const std::system_error& failed) {
    // The system could not start another thread.
    if (failed.code() == std::errc::resource_unavailable_try_again) return OutOfMemory();
    return UnexpectedFailure(failed.what());
  } catch (const std::exception& failed) {
    return UnexpectedFailure(failed.what());
  } catch (...) {
    return UnexpectedFailure("an exception of an unknown type");
  }
}

}  // namespace thunderhead::base
