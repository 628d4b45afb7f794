// The exit codes of the program, for the workflow suites that run it. They follow sysexits.h, so
// that a suite can distinguish failures to retry from permanent ones.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace thunderhead::runs {

enum class ExitCode {
  kDone = 0,
  kBadRequest = 64,    // EX_USAGE: an error in the command line or the scene
  kBadInput = 65,      // EX_DATAERR: a storm file that is damaged or has another format
  kProgramError = 70,  // EX_SOFTWARE: an error of the program itself
  kTryAgain = 75,      // EX_TEMPFAIL: not ready, busy, interrupted, or out of space
  // EX_CONFIG: for example a missing device, or a folder without write permission
  kConfiguration = 78,
};

// Returns the exit code for a status. INVALID_ARGUMENT, OUT_OF_RANGE and ALREADY_EXISTS give
// kBadRequest. DATA_LOSS and a permanent RESOURCE_EXHAUSTED give kBadInput. FAILED_PRECONDITION,
// PERMISSION_DENIED, UNAUTHENTICATED and UNIMPLEMENTED give kConfiguration. Errors that may pass by
// themselves give kTryAgain. NOT_FOUND is one of these, because a file may not exist yet. Other
// errors give kProgramError.
ExitCode ExitCodeOf(const absl::Status& status);

// Returns the table of exit codes for --help.
std::string ExitCodesHelp();

}  // namespace thunderhead::runs
