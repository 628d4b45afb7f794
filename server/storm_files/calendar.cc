#include "storm_files/calendar.h"

#include <algorithm>
#include <array>

#include "absl/strings/ascii.h"
#include "absl/time/civil_time.h"

namespace thunderhead::storm_files {
namespace {

struct NamedCalendar {
  std::string_view name;
  Calendar calendar;
};

constexpr std::array kCalendarNames = {
    NamedCalendar{"standard", Calendar::kStandard},
    NamedCalendar{"proleptic_gregorian", Calendar::kGregorian},
    NamedCalendar{"julian", Calendar::kJulian},
    NamedCalendar{"noleap", Calendar::kNoLeap},
    NamedCalendar{"all_leap", Calendar::kAllLeap},
    NamedCalendar{"360_day", Calendar::k360Day},
    // Synonyms follow, so that NameOf finds the names above.
    NamedCalendar{"", Calendar::kStandard},
    NamedCalendar{"gregorian", Calendar::kStandard},
    NamedCalendar{"365_day", Calendar::kNoLeap},
    NamedCalendar{"no_leap", Calendar::kNoLeap},
    NamedCalendar{"366_day", Calendar::kAllLeap},
};

// The Julian day numbers of 1 January 1970 and of 15 October 1582, the first Gregorian day.
constexpr std::int64_t kUnixEpochDay = 2'440'588;
constexpr std::int64_t kFirstGregorian = 2'299'161;

std::optional<std::int64_t> GregorianDay(const CalendarDate& date) {
  const absl::CivilDay day(date.year, date.month, date.day);
  if (day.month() != date.month || day.day() != date.day) return std::nullopt;
  return day - absl::CivilDay() + kUnixEpochDay;
}

CalendarDate GregorianDate(std::int64_t day) {
  const absl::CivilDay date = absl::CivilDay() + (day - kUnixEpochDay);
  return {date.year(), date.month(), date.day()};
}

// The formulas of Richards (Explanatory Supplement to the Astronomical Almanac, 2013, section
// 15.11) count years from March. Years before 1 are counted without a year 0.
std::int64_t JulianDay(const CalendarDate& date) {
  const std::int64_t astronomical = date.year < 0 ? date.year + 1 : date.year;
  const int before_march = date.month < 3 ? 1 : 0;
  const std::int64_t year = astronomical + 4800 - before_march;
  const int month = date.month + 12 * before_march - 3;
  return date.day + (153 * month + 2) / 5 + 365 * year + year / 4 - 32'083;
}

CalendarDate JulianDate(std::int64_t day) {
  const std::int64_t shifted = day + 32'082;
  const std::int64_t year = (4 * shifted + 3) / 1461;
  const auto of_year = static_cast<int>(shifted - 1461 * year / 4);
  const int month = (5 * of_year + 2) / 153;
  const std::int64_t astronomical = year - 4800 + month / 10;
  return {astronomical < 1 ? astronomical - 1 : astronomical, month + 3 - 12 * (month / 10),
          of_year - (153 * month + 2) / 5 + 1};
}

// The days before each month of a calendar whose years are all alike.
struct EvenYears {
  std::array<int, 13> before;
};

constexpr EvenYears EvenYearsOf(Calendar calendar) {
  EvenYears years{};
  constexpr std::array kLengths = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  for (std::size_t month = 0; month < 12; ++month) {
    int length = kLengths[month] + (month == 1 && calendar == Calendar::kAllLeap ? 1 : 0);
    if (calendar == Calendar::k360Day) length = 30;
    years.before[month + 1] = years.before[month] + length;
  }
  return years;
}

bool HasNoYearZero(Calendar calendar) {
  return calendar == Calendar::kStandard || calendar == Calendar::kJulian;
}

}  // namespace

std::optional<Calendar> CalendarOf(std::string_view name) {
  const std::string lower = absl::AsciiStrToLower(
      absl::StripAsciiWhitespace(absl::string_view(name.data(), name.size())));
  const auto at = std::ranges::find(kCalendarNames, std::string_view(lower), &NamedCalendar::name);
  return at == kCalendarNames.end() ? std::nullopt : std::optional(at->calendar);
}

std::string_view NameOf(Calendar calendar) {
  return std::ranges::find(kCalendarNames, calendar, &NamedCalendar::calendar)->name;
}

std::optional<std::int64_t> DayNumber(Calendar calendar, const CalendarDate& date) {
  if (date.month < 1 || date.month > 12 || date.day < 1) return std::nullopt;
  if (date.year == 0 && HasNoYearZero(calendar)) return std::nullopt;
  if (calendar == Calendar::kGregorian) return GregorianDay(date);
  if (calendar == Calendar::kStandard) {
    const std::optional<std::int64_t> day = GregorianDay(date);
    if (day.has_value() && *day >= kFirstGregorian) return day;
  }
  if (calendar == Calendar::kJulian || calendar == Calendar::kStandard) {
    const std::int64_t day = JulianDay(date);
    if (calendar == Calendar::kStandard && day >= kFirstGregorian) return std::nullopt;
    return JulianDate(day) == date ? std::optional(day) : std::nullopt;
  }
  const EvenYears years = EvenYearsOf(calendar);
  const auto month = static_cast<std::size_t>(date.month);
  if (date.day > years.before[month] - years.before[month - 1]) return std::nullopt;
  return date.year * years.before[12] + years.before[month - 1] + date.day - 1;
}

CalendarDate DateOf(Calendar calendar, std::int64_t day) {
  if (calendar == Calendar::kGregorian) return GregorianDate(day);
  if (calendar == Calendar::kStandard && day >= kFirstGregorian) return GregorianDate(day);
  if (HasNoYearZero(calendar)) return JulianDate(day);
  const EvenYears years = EvenYearsOf(calendar);
  const std::int64_t length = years.before[12];
  const std::int64_t year = (day >= 0 ? day : day - length + 1) / length;
  const auto of_year = static_cast<int>(day - year * length);
  const auto* const after = std::ranges::upper_bound(years.before, of_year);
  const auto month = static_cast<int>(after - years.before.begin());
  return {year, month, of_year - years.before[static_cast<std::size_t>(month) - 1] + 1};
}

absl::Duration DurationIn(Calendar calendar, absl::Time from, absl::Time to) {
  const absl::TimeZone utc = absl::UTCTimeZone();
  const auto midnight = [&](absl::Time time) {
    return absl::CivilDay(absl::ToCivilSecond(time, utc));
  };
  const auto day = [&](absl::Time time) {
    const absl::CivilDay date = midnight(time);
    return DayNumber(calendar, {date.year(), date.month(), date.day()});
  };
  const auto first = day(from);
  const auto last = day(to);
  if (!first.has_value() || !last.has_value()) return to - from;
  const auto of_day = [&](absl::Time time) {
    return time - absl::FromCivil(absl::CivilSecond(midnight(time)), utc);
  };
  return absl::Hours(24 * (*last - *first)) + of_day(to) - of_day(from);
}

}  // namespace thunderhead::storm_files
