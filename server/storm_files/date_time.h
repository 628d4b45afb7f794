// Parses the dates, times of day and units of time that storm files contain. This code does not
// read files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/time/time.h"

namespace thunderhead::storm_files {

// Parses a date of the years 0 to 9999, with or without a time of day and an offset from UTC.
// Examples are "2013-05-20_18:00:00", "2013-5-20 18:00:0.5 +05:30" and "2013-05-20". Dates are in
// the proleptic Gregorian calendar. A date alone means midnight, and a text without an offset is in
// UTC. Returns nothing for any other text, including hours above 23 (such as 24:00:00) and leap
// seconds.
std::optional<absl::Time> ParseDateTime(std::string_view text);

// A date and time of day as a text writes them, in no particular calendar.
struct WrittenDate {
  int year = 0;
  int month = 0;  // 0 to 99; the calendar says which exist
  int day = 0;
  absl::Duration since_midnight;  // in UTC, so it can be negative or longer than a day
};

// Parses a text as ParseDateTime does, but also what UDUNITS accepts: dates that exist only in
// other calendars, years before 0, the compact form "20130520", and offsets without a sign.
std::optional<WrittenDate> ParseWrittenDate(std::string_view text);

// Returns the start of a storm without a date. It counts as idealised and begins in year 1, as in
// WRF.
absl::Time StartWithoutDate();

// Returns units such as "hours after 2013-05-20" with the word "since". UDUNITS knows after, from,
// ref and @ as other words for it. A text without a date is returned as it is.
std::string WithSince(std::string_view units);

struct TimeUnits {
  double seconds = 1.0;              // seconds in one unit
  std::optional<absl::Time> origin;  // the date after "since"; nothing if there is none
};

// Parses units such as "minutes since 2013-05-20 18:00" or "s". The units may be seconds, minutes,
// hours or days, but not months and years, because these have no fixed length.
std::optional<TimeUnits> ParseTimeUnits(std::string_view units);

}  // namespace thunderhead::storm_files
