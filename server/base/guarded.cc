#include "base/guarded.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "base/log.h"

namespace thunderhead::base {

absl::Status UnexpectedFailure(const char* what) {
  LogError(absl::InternalError(absl::StrCat("a request failed unexpectedly: ", what)));
  return WithDetails(absl::InternalError("the server failed at this request; its log says why"),
                     {.reason = "UNEXPECTED_FAILURE"});
}

}  // namespace thunderhead::base
