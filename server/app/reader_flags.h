// The flags that limit the confined processes in which storm files are read.
#pragma once

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "base/machine_memory.h"
#include "sandbox/readers.h"

namespace thunderhead::app {

struct ReaderFlags {
  double memory_mib = static_cast<double>(base::MachineMemoryBytes() >> 20);
  double seconds = 600.0;
};

void AddReaderFlags(CLI::App& command, ReaderFlags& flags);

sandbox::ReaderLimits LimitsOf(const ReaderFlags& flags);

// Returns FAILED_PRECONDITION if this machine cannot confine a reader process, so that no storm
// file can be read.
absl::Status ProbeReaders(const sandbox::ReaderLimits& limits);

}  // namespace thunderhead::app
