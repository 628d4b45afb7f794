// Functions and macros for status values. An error from input or the environment is an absl::Status
// that says what went wrong, where, and what to do next. A broken invariant of the program itself
// is a THUNDERHEAD_CHECK. No library lets an exception escape.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::base {

// Returns `status` with `prefix` and ": " inserted before its message. Payloads are kept, and OK
// stays OK.
absl::Status Annotate(const absl::Status& status, std::string_view prefix);

// Prints the failed condition, its place in the source and `detail`, then aborts.
[[noreturn]] void CheckFailed(const char* file, int line, const char* condition,
                              const std::string& detail);

}  // namespace thunderhead::base

// Returns the status `expression` from the calling function if it is not OK.
#define THUNDERHEAD_RETURN_IF_ERROR(expression)                                     \
  do {                                                                              \
    if (absl::Status thunderhead_status = (expression); !thunderhead_status.ok()) { \
      return thunderhead_status;                                                    \
    }                                                                               \
  } while (false)

#define THUNDERHEAD_CONCATENATE_INNER(a, b) a##b
#define THUNDERHEAD_CONCATENATE(a, b) THUNDERHEAD_CONCATENATE_INNER(a, b)

// Assigns the value of a StatusOr, or returns its error from the calling function. Use it like
// this: THUNDERHEAD_ASSIGN_OR_RETURN(auto value, Function()).
// NOLINTBEGIN(bugprone-macro-parentheses): a declaration cannot stand in parentheses.
#define THUNDERHEAD_ASSIGN_OR_RETURN(declaration, expression)                      \
  auto THUNDERHEAD_CONCATENATE(thunderhead_or_, __LINE__) = (expression);          \
  if (!THUNDERHEAD_CONCATENATE(thunderhead_or_, __LINE__).ok()) {                  \
    return std::move(THUNDERHEAD_CONCATENATE(thunderhead_or_, __LINE__)).status(); \
  }                                                                                \
  declaration = *std::move(THUNDERHEAD_CONCATENATE(thunderhead_or_, __LINE__))
// NOLINTEND(bugprone-macro-parentheses)

// If `condition` is false, prints file, line, condition and `detail` (a string expression that
// shows the values) and aborts.
#define THUNDERHEAD_CHECK(condition, detail)                                    \
  do {                                                                          \
    if (!(condition)) {                                                         \
      ::thunderhead::base::CheckFailed(__FILE__, __LINE__, #condition, detail); \
    }                                                                           \
  } while (false)
