// The limits that the system sets for the memory and the threads of this process (setrlimit).
#pragma once

#include <sys/resource.h>

#include <string>

#include "absl/status/status.h"

namespace thunderhead::base {

// Soft limits; RLIM_INFINITY for none.
struct ProcessLimits {
  rlim_t address_space_bytes = RLIM_INFINITY;
  rlim_t data_bytes = RLIM_INFINITY;
  rlim_t threads = RLIM_INFINITY;  // processes and threads of the user
};

ProcessLimits ReadProcessLimits();

// Returns a text that names the limits, such as "the limits of this process are an address space of
// 600 MiB (RLIMIT_AS, ulimit -v)". Returns an empty text if there are none.
std::string TextOf(const ProcessLimits& limits);

// Returns FAILED_PRECONDITION if a server cannot start within the limits on memory. The libraries
// that it uses end the process, without an error, if they get no memory or thread.
absl::Status CheckProcessLimits(const ProcessLimits& limits);

// From now on, an exception that no code handles ends the process with a message that contains the
// limits. Libraries throw such exceptions in their own threads.
void TellLimitsAtUnhandledExceptions();

}  // namespace thunderhead::base
