// How the program ends, for the suites that run it: by sysexits.h, so that a suite can tell what to
// try again from what never to try again.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace thunderhead::app {

enum class ExitCode {
  kDone = 0,
  kBadRequest = 64,     // EX_USAGE: the command line or the scene
  kBadInput = 65,       // EX_DATAERR: a storm file that is damaged or of another kind
  kProgramError = 70,   // EX_SOFTWARE: the program's own
  kTryAgain = 75,       // EX_TEMPFAIL: not ready, busy, interrupted, no room
  kConfiguration = 78,  // EX_CONFIG: no such device, a folder that may not be written to
};

// By the status's code alone: INVALID_ARGUMENT is a bad request, DATA_LOSS bad input,
// FAILED_PRECONDITION and PERMISSION_DENIED configuration, what may pass by itself (NOT_FOUND of a
// file included, as it may not be there yet) worth another try.
ExitCode ExitCodeOf(const absl::Status& status);

// The table, for --help.
std::string ExitCodesHelp();

}  // namespace thunderhead::app
