// Dates and times in messages, flags and the program's own files.
#pragma once

#include <optional>
#include <string>

#include "absl/time/time.h"

namespace thunderhead::base {

// Parses a date and time by RFC 3339, such as "2013-05-20T20:00:00Z", or with an offset such as
// "+05:30". The years 0 to 9999 are valid. Returns nothing for any other text. In contrast to
// absl::ParseTime, it does not accept "infinite-future" or years with more than four digits.
std::optional<absl::Time> ParseUtcTime(const std::string& text);

}  // namespace thunderhead::base
