#include "runs/exit_codes.h"

#include "base/error_details.h"

namespace thunderhead::runs {

ExitCode ExitCodeOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return ExitCode::kDone;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kAlreadyExists:
      return ExitCode::kBadRequest;
    case absl::StatusCode::kDataLoss:
      return ExitCode::kBadInput;
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kUnimplemented:
      return ExitCode::kConfiguration;
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kDeadlineExceeded:
      return ExitCode::kTryAgain;
    case absl::StatusCode::kResourceExhausted:
      // A file that needs more memory than its reader may use needs as much at the next try.
      return base::DetailsOf(status).permanent ? ExitCode::kBadInput : ExitCode::kTryAgain;
    default:
      return ExitCode::kProgramError;
  }
}

std::string ExitCodesHelp() {
  return "Exit codes:\n"
         "  0   all is done\n"
         "  64  bad request: the command line or the scene is wrong\n"
         "  65  bad input: a storm file is damaged, too large or of another kind; trying again "
         "does not "
         "help\n"
         "  70  an error of the program itself\n"
         "  75  not now: a file is missing or still being written, something is busy or full, or "
         "a\n"
         "      signal came; try again\n"
         "  78  configuration: no such device, or a folder that may not be written to\n"
         "  A code above 128 means that a signal ended the program at once.";
}

}  // namespace thunderhead::runs
