#include "storm_files/cf_times.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "base/status.h"
#include "spdlog/spdlog.h"
#include "storm_files/calendar.h"
#include "storm_files/date_time.h"
#include "storm_files/storm_file.h"
#include "storm_files/units.h"

namespace thunderhead::storm_files {
namespace {

constexpr double kSecondsPerDay = 86'400.0;

// Times are rounded to a millisecond, because a number of days is seldom exact.
constexpr double kMillisecond_s = 1e-3;

// Returns whether a unit of time is a month or a year. UDUNITS gives them their mean lengths.
bool IsMonthOrYear(double seconds) {
  // A fortnight is the longest unit of a fixed length that anyone uses.
  constexpr double kLongest_s = 20.0 * kSecondsPerDay;
  return seconds > kLongest_s;
}

absl::Status BadUnits(const std::string& units, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat(
      "has ", units.empty() ? "no units" : absl::StrCat("units '", absl::CEscape(units), "'"),
      why));
}

constexpr std::string_view kExample =
    " where 'seconds since 2013-05-20 18:00:00' or the like is needed (s, min, h or days; an "
    "offset "
    "such as +05:30 may follow); correct them";

// Returns a time of a calendar as a time with the same date. Days that only the calendar has are an
// error.
absl::StatusOr<absl::Time> TimeOfDay(Calendar calendar, std::int64_t day, double seconds) {
  const CalendarDate date = DateOf(calendar, day);
  const absl::CivilDay civil(date.year, date.month, date.day);
  if (civil.month() != date.month || civil.day() != date.day) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "has the date %04d-%02d-%02d of the calendar %s, which the common calendar lacks; choose "
        "other times, or write them in the calendar 'standard'",
        date.year, date.month, date.day, std::string(NameOf(calendar))));
  }
  return absl::FromCivil(absl::CivilSecond(civil), absl::UTCTimeZone()) +
         absl::Milliseconds(std::llround(seconds / kMillisecond_s));
}

// Returns the time `seconds` after a day's midnight.
absl::StatusOr<absl::Time> TimeAfter(Calendar calendar, std::int64_t day, double seconds) {
  constexpr double kMost_s = 1e12;  // 30 thousand years
  if (!(std::abs(seconds) < kMost_s)) {
    return absl::InvalidArgumentError("has a time outside the years 0 to 9999; check its units");
  }
  const double rounded = std::round(seconds / kMillisecond_s) * kMillisecond_s;
  const double days = std::floor(rounded / kSecondsPerDay);
  return TimeOfDay(calendar, day + static_cast<std::int64_t>(days),
                   rounded - days * kSecondsPerDay);
}

// Decodes "day as %Y%m%d.%f", with which CDO writes absolute times.
absl::StatusOr<std::vector<absl::Time>> DecodeAbsolute(const std::vector<double>& values,
                                                       const std::string& units,
                                                       Calendar calendar) {
  if (!absl::StrContains(units, "%Y%m%d.%f") || !absl::StartsWithIgnoreCase(units, "day as ")) {
    return BadUnits(units,
                    ", and of absolute times only 'day as %Y%m%d.%f' gives the day; write relative "
                    "times, for example with cdo -r copy");
  }
  std::vector<absl::Time> times;
  for (const double value : values) {
    const double whole = std::floor(value);
    constexpr double kYear10000 = 1e8;
    if (!(whole >= 0.0 && whole < kYear10000))
      return BadUnits(units, absl::StrCat(" and the value ", value, ", which is no date"));
    const auto number = static_cast<std::int64_t>(whole);
    const CalendarDate date{number / 10'000, static_cast<int>(number / 100 % 100),
                            static_cast<int>(number % 100)};
    const std::optional<std::int64_t> day = DayNumber(calendar, date);
    if (!day.has_value()) {
      return BadUnits(units,
                      absl::StrCat(" and the value ", number, ", which is no date of the calendar ",
                                   std::string(NameOf(calendar))));
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(const absl::Time time,
                                 TimeAfter(calendar, *day, (value - whole) * kSecondsPerDay));
    times.push_back(time);
  }
  return times;
}

struct CountedFrom {
  double unit_s = 1.0;
  std::optional<WrittenDate> origin;  // nothing if the units have no "since"
};

absl::StatusOr<CountedFrom> ParseUnits(const std::string& written) {
  const std::string units = WithSince(written);
  const std::string lower = absl::AsciiStrToLower(units);
  constexpr std::string_view kSince = " since ";
  const std::size_t since = lower.find(std::string(kSince));
  const std::string unit(absl::StripAsciiWhitespace(units.substr(0, since)));
  const std::optional<UnitConversion> seconds = ConversionOf(unit, "s");
  // UDUNITS also accepts "10 minutes" as a unit. It is refused, because a file with such a unit is
  // probably wrong.
  const bool named = seconds.has_value() && !unit.empty() && !absl::ascii_isdigit(unit[0]);
  if (!named || !(seconds->scale > 0.0) || seconds->offset != 0.0) {
    return BadUnits(units, std::string(kExample));
  }
  if (IsMonthOrYear(seconds->scale)) {
    return BadUnits(units,
                    "; months and years have no fixed length, so the times are not known: write "
                    "them in days, hours, minutes or seconds");
  }
  CountedFrom counted{seconds->scale, std::nullopt};
  if (since == std::string::npos) return counted;
  const std::string date(absl::StripAsciiWhitespace(units.substr(since + kSince.size())));
  counted.origin = ParseWrittenDate(date);
  if (counted.origin.has_value()) return counted;
  return BadUnits(units, std::string(kExample));
}

// Returns why a date that a text writes does not exist.
std::string WhyNoDay(const WrittenDate& date, Calendar calendar) {
  if (date.month == 0 || date.day == 0) {
    return "; its reference date has a month or a day 0, which no calendar has: count from a real "
           "day";
  }
  if (date.year == 0) {
    return absl::StrCat(
        "; the calendar ", std::string(NameOf(calendar)),
        " has no year 0, so its days are not known: count from a later year, or set "
        "the attribute calendar to 'proleptic_gregorian'");
  }
  return absl::StrCat(" whose reference date does not exist in the calendar ",
                      std::string(NameOf(calendar)), std::string(kExample));
}

// Returns whether all times are in the first days after a reference date in year 0. Only such a
// storm, which is idealised, may count from a year that its calendar lacks.
bool StaysInYearZero(const CountedFrom& counted, const std::vector<double>& values) {
  const double latest = *std::ranges::max_element(values);
  constexpr double kMonth_s = 28.0 * kSecondsPerDay;
  return counted.origin->year == 0 && counted.origin->month == 1 && counted.origin->day == 1 &&
         latest * counted.unit_s < kMonth_s;
}

std::vector<std::string> WordsOf(const std::string& text) {
  return absl::StrSplit(text, absl::ByAnyChar(" \t\n,"), absl::SkipEmpty());
}

// Returns how well a variable serves as the time of the records: 0 if it does not.
int SuitsAsTime(const netcdf::NetcdfFile& file, const std::string& name) {
  const std::string standard_name = file.TextOrEmpty(name, "standard_name");
  if (standard_name == "time") return 4;
  if (!standard_name.empty()) return 0;
  if (name == "valid_time") return 3;
  const std::string units = absl::AsciiStrToLower(WithSince(file.TextOrEmpty(name, "units")));
  const bool counts = absl::StrContains(units, " since ") || absl::StartsWith(units, "day as ");
  if (!counts) return 0;
  const std::string lower = absl::AsciiStrToLower(name);
  const bool is_reference = absl::StrContains(lower, "ref") || absl::StrContains(lower, "start") ||
                            absl::StrContains(lower, "init") || absl::StrContains(lower, "bnds") ||
                            absl::StrContains(lower, "bounds");
  if (is_reference) return 0;
  return lower == "time" ? 2 : 1;
}

// Returns the variable with the times, or nothing if the file has none.
std::optional<std::string> FindTime(const netcdf::NetcdfFile& file, const std::string& variable,
                                    const std::string& dimension) {
  std::optional<std::string> best;
  int most = 0;
  const std::vector<std::string> coordinates = WordsOf(file.TextOrEmpty(variable, "coordinates"));
  for (const std::string& name : file.Variables()) {
    const auto on = file.Dimensions(name);
    const auto shape = file.Shape(name);
    if (!on.ok() || !shape.ok()) continue;
    const bool along = !dimension.empty() && *on == std::vector<std::string>{dimension};
    const bool single = std::ranges::all_of(*shape, [](std::size_t length) { return length == 1; });
    if (!along && (!single || !dimension.empty())) continue;
    int suits = SuitsAsTime(file, name);
    if (suits == 0 && along && name == dimension &&
        file.TextOrEmpty(name, "standard_name") != "forecast_period") {
      suits = 1;
    }
    if (suits == 0) continue;
    suits = 2 * suits + (std::ranges::find(coordinates, name) != coordinates.end() ? 1 : 0);
    if (suits <= most) continue;
    most = suits;
    best = name;
  }
  return best;
}

// Returns the variable with this standard name, along the dimension or with a single value.
std::optional<std::string> FindNamed(const netcdf::NetcdfFile& file, const std::string& dimension,
                                     const char* standard_name) {
  for (const std::string& name : file.Variables()) {
    if (file.TextOrEmpty(name, "standard_name") != standard_name) continue;
    const auto on = file.Dimensions(name);
    if (on.ok() && (on->empty() || *on == std::vector<std::string>{dimension})) return name;
  }
  return std::nullopt;
}

absl::StatusOr<std::vector<double>> ReadTimeValues(const netcdf::NetcdfFile& file,
                                                   const std::string& name, std::size_t records) {
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<double> values, file.ReadDoubles(name));
  if (values.size() != records) {
    return absl::InvalidArgumentError(absl::StrCat(file.Path(), ": the coordinate ", name, " has ",
                                                   values.size(), " values for ", records,
                                                   " times; it must have one each"));
  }
  if (std::ranges::all_of(values, [](double value) { return std::isfinite(value); })) return values;
  return absl::InvalidArgumentError(
      absl::StrCat(file.Path(), ": the coordinate ", name, " has missing values; fill them in"));
}

// Returns whether two calendars have the same days since 1582.
bool HaveEqualDays(const std::string& one, const std::string& other) {
  const auto days_of = [](const std::string& name) {
    const std::optional<Calendar> calendar = CalendarOf(name);
    return calendar == Calendar::kStandard ? Calendar::kGregorian : calendar;
  };
  return days_of(one) == days_of(other);
}

// Returns the forecast_reference_time of each time, or one for all of them. It is empty if the file
// has none. It counts in `calendar` unless it names another, which is an error.
absl::StatusOr<std::vector<absl::Time>> ReadReferenceTimes(const netcdf::NetcdfFile& file,
                                                           const std::string& dimension,
                                                           const std::string& calendar) {
  const auto reference = FindNamed(file, dimension, "forecast_reference_time");
  if (!reference.has_value()) return std::vector<absl::Time>();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> values, file.ReadDoubles(*reference));
  const std::string own = file.TextOrEmpty(*reference, "calendar");
  if (!own.empty() && !HaveEqualDays(own, calendar)) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the coordinate ", *reference, " counts in the calendar '", own,
                     "', and the times in another; give both the same"));
  }
  auto times =
      DecodeCfTimes(values, file.TextOrEmpty(*reference, "units"), own.empty() ? calendar : own);
  if (times.ok()) return times;
  return base::Annotate(times.status(), absl::StrCat(file.Path(), ": the coordinate ", *reference));
}

// Returns when the run began. A reference time that cannot be read is reported and left out,
// because the storm can be shown without it.
std::optional<absl::Time> RunStartOf(const netcdf::NetcdfFile& file, const std::string& dimension,
                                     const std::string& calendar,
                                     std::vector<std::string>& assumptions) {
  const auto references = ReadReferenceTimes(file, dimension, calendar);
  if (!references.ok()) {
    spdlog::warn("{}", std::string(references.status().message()));
    assumptions.emplace_back(
        "The start of the run is not known, because the forecast_reference_time cannot be read in "
        "the calendar of the times.");
    return std::nullopt;
  }
  if (references->empty() ||
      std::ranges::adjacent_find(*references, std::not_equal_to<>()) != references->end()) {
    return std::nullopt;
  }
  return references->front();
}

// Returns the time `seconds` after another time of the calendar.
absl::StatusOr<absl::Time> TimeAfter(Calendar calendar, absl::Time from, double seconds) {
  const absl::CivilSecond civil = absl::ToCivilSecond(from, absl::UTCTimeZone());
  const absl::CivilDay date(civil);
  const auto day = DayNumber(calendar, {date.year(), date.month(), date.day()});
  if (!day.has_value()) return from + absl::Seconds(seconds);
  const absl::Time midnight = absl::FromCivil(absl::CivilSecond(date), absl::UTCTimeZone());
  return TimeAfter(calendar, *day, absl::ToDoubleSeconds(from - midnight) + seconds);
}

void NoteCalendar(CfTimes& read) {
  if (read.calendar == Calendar::kStandard || read.calendar == Calendar::kGregorian) return;
  read.assumptions.push_back(absl::StrCat("The dates are those of the file's calendar ",
                                          std::string(NameOf(read.calendar)), "."));
}

// Reads times that are the sum of a reference time and a period, as files made from GRIB have them.
// Returns nothing if the file has no such pair.
absl::StatusOr<std::optional<CfTimes>> ReadReferenceAndPeriod(const netcdf::NetcdfFile& file,
                                                              const std::string& dimension,
                                                              std::size_t records) {
  const auto period = FindNamed(file, dimension, "forecast_period");
  if (!period.has_value()) return std::optional<CfTimes>();
  const std::optional<UnitConversion> seconds =
      ConversionOf(file.TextOrEmpty(*period, "units"), "s");
  if (!seconds.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the coordinate ", *period, " has units '",
                     file.TextOrEmpty(*period, "units"), "' where a unit of time is needed"));
  }
  const auto reference = FindNamed(file, dimension, "forecast_reference_time");
  const std::string name = reference.has_value() ? file.TextOrEmpty(*reference, "calendar") : "";
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<absl::Time> times,
                               ReadReferenceTimes(file, dimension, name));
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<double> after, file.ReadDoubles(*period));
  if (times.size() == 1) times.resize(records, times[0]);
  if (after.size() == 1) after.resize(records, after[0]);
  if (times.size() != records || after.size() != records) return std::optional<CfTimes>();
  CfTimes read;
  read.calendar = *CalendarOf(name);
  for (std::size_t i = 0; i < records; ++i) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const absl::Time time,
                                 TimeAfter(read.calendar, times[i], (*seconds)(after[i])));
    read.times.push_back(time);
  }
  read.run_start = RunStartOf(file, dimension, name, read.assumptions);
  NoteCalendar(read);
  return std::optional(std::move(read));
}

// Reads times that are written as text, as MPAS writes them ("2013-05-20_18:00:00" in xtime).
// Returns nothing if the file has none.
absl::StatusOr<std::optional<std::vector<absl::Time>>> ReadWrittenTimes(
    const netcdf::NetcdfFile& file, const std::string& dimension, std::size_t records) {
  constexpr const char* kName = "xtime";
  constexpr std::size_t kLongest = 1000;  // characters; MPAS has 64
  const auto on = file.Dimensions(kName);
  const auto shape = file.Shape(kName);
  const bool along = on.ok() && shape.ok() && on->size() == 2 && on->front() == dimension &&
                     shape->front() == records && shape->back() <= kLongest;
  if (!along) return std::optional<std::vector<absl::Time>>();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::string> rows, file.ReadRows(kName));
  std::vector<absl::Time> times;
  for (const std::string& row : rows) {
    const std::string text(absl::StripAsciiWhitespace(row));
    const std::optional<absl::Time> time = ParseDateTime(text);
    if (!time.has_value()) {
      return absl::InvalidArgumentError(
          absl::StrCat(file.Path(), ": ", kName, " has the time '", absl::CEscape(text),
                       "' where one such as 2013-05-20_18:00:00 is needed; correct it"));
    }
    times.push_back(*time);
  }
  return std::optional(std::move(times));
}

// Returns the date from which PALM and other models count, if the file gives it apart from the
// units.
std::string OriginOf(const netcdf::NetcdfFile& file, const std::string& name) {
  for (const auto& holder : {name, std::string()}) {
    if (std::string origin = file.TextOrEmpty(holder, "origin_time"); !origin.empty()) {
      return origin;
    }
  }
  return "";
}

// Reports times that fall. The storm's times are sorted later, and times that occur twice are
// reported then.
void ReportOrder(const std::string& name, CfTimes& read) {
  if (std::ranges::is_sorted(read.times)) return;
  read.assumptions.push_back(
      absl::StrCat("The times of ", name, " do not rise; they are put in order."));
}

absl::StatusOr<CfTimes> TimesWithoutDate(const netcdf::NetcdfFile& file, std::string reason) {
  spdlog::warn("{}: {}", file.Path(), reason);
  return CfTimes{{StartWithoutDate()}, {std::move(reason)}, {}};
}

}  // namespace

absl::StatusOr<std::vector<absl::Time>> DecodeCfTimes(const std::vector<double>& values,
                                                      const std::string& units,
                                                      const std::string& calendar_name) {
  const std::optional<Calendar> calendar = CalendarOf(calendar_name);
  if (!calendar.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat("counts in the calendar '", absl::CEscape(calendar_name),
                     "', which is not known; write its times in the calendar 'standard'"));
  }
  if (absl::StrContains(absl::AsciiStrToLower(units), " as %"))
    return DecodeAbsolute(values, units, *calendar);
  THUNDERHEAD_ASSIGN_OR_RETURN(const CountedFrom counted, ParseUnits(units));
  const WrittenDate origin = counted.origin.value_or(WrittenDate{1, 1, 1, {}});
  Calendar used = *calendar;
  auto day = DayNumber(used, {origin.year, origin.month, origin.day});
  if (!day.has_value() && !values.empty() && StaysInYearZero(counted, values)) {
    used = Calendar::kGregorian;
    day = DayNumber(used, {origin.year, origin.month, origin.day});
  }
  if (!day.has_value()) return BadUnits(units, WhyNoDay(origin, *calendar));
  const double since_midnight_s = absl::ToDoubleSeconds(origin.since_midnight);
  std::vector<absl::Time> times;
  for (const double value : values) {
    THUNDERHEAD_ASSIGN_OR_RETURN(const absl::Time time,
                                 TimeAfter(used, *day, since_midnight_s + value * counted.unit_s));
    times.push_back(time);
  }
  return times;
}

absl::StatusOr<CfTimes> ReadCfTimes(const netcdf::NetcdfFile& file, const std::string& variable,
                                    const std::string& dimension) {
  const std::size_t records = dimension.empty() ? 1 : file.DimensionLength(dimension).value_or(0);
  if (records == 0) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": holds no times yet; the model may still be writing it: try again later"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckRecords(file.Path(), records));
  const std::optional<std::string> name = FindTime(file, variable, dimension);
  if (!name.has_value()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(auto times, ReadReferenceAndPeriod(file, dimension, records));
    if (times.has_value()) return *std::move(times);
    THUNDERHEAD_ASSIGN_OR_RETURN(auto written, ReadWrittenTimes(file, dimension, records));
    if (written.has_value()) return CfTimes{*std::move(written), {}, {}};
    if (records == 1) return CfTimes{{StartWithoutDate()}, {}, {}};
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": the dimension ", dimension, " has no coordinate variable ", dimension,
        ", so its times are not known; add one with units such as 'seconds "
        "since 2013-05-20 18:00:00'"));
  }
  std::string units(absl::StripAsciiWhitespace(file.TextOrEmpty(*name, "units")));
  if (units.empty() && records == 1) {
    return TimesWithoutDate(file,
                            "The only time has no units; it is taken as that of an idealised run.");
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> values,
                               ReadTimeValues(file, *name, records));
  const std::string calendar = file.TextOrEmpty(*name, "calendar");
  // MicroHH counts "seconds since start".
  constexpr absl::string_view kSinceStart = " since start";
  if (absl::EndsWithIgnoreCase(units, kSinceStart)) {
    units.resize(units.size() - kSinceStart.size());
  }
  CfTimes read;
  if (!absl::StrContains(absl::AsciiStrToLower(WithSince(units)), " since ") &&
      !absl::StrContains(units, " as %")) {
    if (const std::string origin = OriginOf(file, *name); !origin.empty() && !units.empty()) {
      units = absl::StrCat(units, " since ", origin);
    } else if (!units.empty()) {
      read.assumptions.push_back(absl::StrCat(
          *name, " counts from no date; it is taken as the time of an idealised run."));
      spdlog::warn("{}: {}", file.Path(), read.assumptions.back());
    }
  }
  auto times = DecodeCfTimes(values, units, calendar);
  if (!times.ok()) {
    return absl::Status(times.status().code(),
                        absl::StrCat(file.Path(), ": the coordinate ", *name, " ",
                                     std::string(times.status().message())));
  }
  read.times = *std::move(times);
  read.run_start = RunStartOf(file, dimension, calendar, read.assumptions);
  read.calendar = *CalendarOf(calendar);
  NoteCalendar(read);
  ReportOrder(*name, read);
  return read;
}

}  // namespace thunderhead::storm_files
