// Dates and times of messages, flags and the program's own files.
#pragma once

#include <optional>
#include <string>

#include "absl/time/time.h"

namespace thunderhead::base {

// Parses a date and time by RFC 3339, such as "2013-05-20T20:00:00Z" or one with an offset such as
// "+05:30", of the years 0 to 9999. Returns nothing for any other text, also for those that
// absl::ParseTime takes in addition: "infinite-future", and years of more digits.
std::optional<absl::Time> ParseUtcTime(const std::string& text);

}  // namespace thunderhead::base
