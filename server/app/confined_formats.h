// The file formats with which commands open storm files. Every file is described and read in a
// confined process (sandbox/confined_files.h).
#pragma once

#include "CLI/CLI.hpp"
#include "base/machine_memory.h"
#include "sandbox/confined_files.h"
#include "storm_files/storm_format.h"

namespace thunderhead::app {

storm_files::StormFormats ConfinedFormats(const sandbox::ConfinedOptions& options = {});

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
