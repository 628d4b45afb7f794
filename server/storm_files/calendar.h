// The calendars of the CF conventions (section 4.4.1). A storm's times have the dates of the file's
// own calendar, so the model's seasons and times of day are kept.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/time/time.h"

namespace thunderhead::storm_files {

enum class Calendar {
  kStandard,   // Julian until 4 October 1582, Gregorian from 15 October 1582
  kGregorian,  // Gregorian at all times ("proleptic_gregorian")
  kJulian,
  kNoLeap,   // 365 days in every year
  kAllLeap,  // 366 days in every year
  k360Day,   // 12 months of 30 days
};

// Returns the calendar of a `calendar` attribute; an empty text means the standard calendar.
// Returns nothing for any other text.
std::optional<Calendar> CalendarOf(std::string_view name);

// Returns the calendar's name in the CF conventions.
std::string_view NameOf(Calendar calendar);

struct CalendarDate {
  std::int64_t year = 0;
  int month = 1;
  int day = 1;

  bool operator==(const CalendarDate&) const = default;
};

// Returns the number of the day, counted from a day that depends on the calendar. Returns nothing
// if the calendar has no such day. The standard and the Julian calendar have no year 0.
std::optional<std::int64_t> DayNumber(Calendar calendar, const CalendarDate& date);

// Returns the date of a day. It is the inverse of DayNumber for days from year -4000 to 20000.
CalendarDate DateOf(Calendar calendar, std::int64_t day);

// Returns the duration between two times whose dates are dates of `calendar`. If the calendar lacks
// one of these dates, the proleptic Gregorian calendar is used.
absl::Duration DurationIn(Calendar calendar, absl::Time from, absl::Time to);

}  // namespace thunderhead::storm_files
