#include "storm_files/wrf_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "base/status.h"
#include "storm_files/date_time.h"
#include "storm_files/storm_file.h"

namespace thunderhead::storm_files {
namespace {

// WRF writes this date for a run without a date.
constexpr char kZeroDate[] = "0000-00-00";
constexpr char kFirstDate[] = "0001-01-01";

// Calendars in which dates are those of ParseDateTime, after 1582.
constexpr std::array<std::string_view, 4> kCalendars = {"", "standard", "gregorian",
                                                        "proleptic_gregorian"};

bool HasZeroDate(const std::string& text) { return text.find(kZeroDate) != std::string::npos; }

std::string WithFirstDate(const std::string& text) {
  return absl::StrReplaceAll(text, {{kZeroDate, kFirstDate}});
}

// Parses a row of Times. Returns nothing for a row that is shorter than a time with seconds,
// because WRF has only partly written such a row.
std::optional<absl::Time> ParseWrfTime(const std::string& text) {
  constexpr std::size_t kWhole = std::string_view("2013-05-20_20:00:00").size();
  if (absl::StripAsciiWhitespace(text).size() < kWhole) return std::nullopt;
  return ParseDateTime(WithFirstDate(text));
}

// Returns when the run began, by the attribute `name`, or nothing if the file does not have it.
absl::StatusOr<std::optional<absl::Time>> ReadStart(const netcdf::NetcdfFile& file,
                                                    const std::string& name) {
  const std::string text = file.TextOrEmpty("", name);
  if (text.empty()) return std::optional<absl::Time>();
  std::optional<absl::Time> start = ParseWrfTime(text);
  if (!start.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": the attribute ", name, " is '", absl::CEscape(text),
                     "', not a date like 2013-05-20_20:00:00; correct it"));
  }
  return start;
}

absl::StatusOr<std::optional<absl::Time>> ReadAnyStart(const netcdf::NetcdfFile& file) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<absl::Time> start,
                               ReadStart(file, "SIMULATION_START_DATE"));
  if (start.has_value()) return start;
  return ReadStart(file, "START_DATE");
}

// Returns the units of the variable `name`. XTIME counts minutes since the start of the run unless
// the file says otherwise.
absl::StatusOr<TimeUnits> ReadUnits(const netcdf::NetcdfFile& file, const std::string& name) {
  const std::string text = file.TextOrEmpty(name, "units");
  const std::optional<TimeUnits> units =
      ParseTimeUnits(text.empty() ? "minutes" : WithFirstDate(text));
  if (!units.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", name, " has units '", absl::CEscape(text),
                     "' where 'minutes since 2013-05-20 12:00:00' or the like is needed; correct "
                     "them"));
  }
  const std::string calendar = absl::AsciiStrToLower(file.TextOrEmpty(name, "calendar"));
  if (std::ranges::find(kCalendars, calendar) == kCalendars.end()) {
    return absl::InvalidArgumentError(absl::StrCat(
        file.Path(), ": ", name, " has the calendar '", absl::CEscape(calendar),
        "' where 'standard' is needed; extract the variable Times, or convert ", name));
  }
  if (units->origin.has_value()) return *units;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::optional<absl::Time> start, ReadAnyStart(file));
  return TimeUnits{units->seconds, start};
}

// Returns the name of the variable that counts time, or an empty text. A coordinate variable of
// another name than XTIME is used only if it counts from a date.
std::string CounterOf(const netcdf::NetcdfFile& file, const WrfLayout& layout) {
  if (file.HasVariable("XTIME")) return "XTIME";
  for (const std::string& name : {layout.time, std::string("Time"), std::string("time")}) {
    if (name.empty() || !file.HasVariable(name)) continue;
    const std::optional<TimeUnits> units = ParseTimeUnits(file.TextOrEmpty(name, "units"));
    if (units.has_value() && units->origin.has_value()) return name;
  }
  return "";
}

absl::StatusOr<std::vector<absl::Time>> CountedTimes(const netcdf::NetcdfFile& file,
                                                     const WrfLayout& layout) {
  const std::string name = CounterOf(file, layout);
  TimeUnits units;
  if (!name.empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(units, ReadUnits(file, name));
  }
  if (!units.origin.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": has no variable Times (nor XTIME with the attribute ",
                     "SIMULATION_START_DATE); extract Times as well"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::size_t> shape, file.Shape(name));
  if (shape.size() > 1) {
    return absl::InvalidArgumentError(
        absl::StrCat(file.Path(), ": ", name, " has dimensions ", AsText(shape), ", not (time)"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<double> values, file.ReadDoubles(name));
  std::vector<absl::Time> times;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      return absl::DataLossError(absl::StrCat(file.Path(), ": ", name, " of record ", i,
                                              " is missing; write the file again"));
    }
    times.push_back(*units.origin + absl::Seconds(std::round(values[i] * units.seconds)));
  }
  return times;
}

// Returns the rows of Times. They are empty if the file does not have Times as text.
absl::StatusOr<std::vector<std::string>> RowsOf(const netcdf::NetcdfFile& file) {
  if (!file.HasVariable("Times")) return std::vector<std::string>();
  absl::StatusOr<std::vector<std::string>> rows = file.ReadRows("Times");
  if (absl::IsInvalidArgument(rows.status())) return std::vector<std::string>();
  return rows;
}

absl::StatusOr<std::vector<absl::Time>> WrittenTimes(const netcdf::NetcdfFile& file,
                                                     const std::vector<std::string>& rows) {
  std::vector<absl::Time> times;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::optional<absl::Time> time = ParseWrfTime(rows[i]);
    if (!time.has_value()) {
      return absl::DataLossError(absl::StrCat(
          file.Path(), ": Times of record ", i, " is '", absl::CEscape(rows[i]),
          "', not a date like 2013-05-20_20:00:00; correct it, or write the file again"));
    }
    times.push_back(*time);
  }
  return times;
}

}  // namespace

absl::StatusOr<WrfTimes> ReadWrfTimes(const netcdf::NetcdfFile& file, const WrfLayout& layout) {
  if (layout.records == 0) {
    return absl::DataLossError(absl::StrCat(file.Path(), ": holds no times: its dimension ",
                                            layout.time, " is empty; write the file again"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckRecords(file.Path(), layout.records));
  WrfTimes read;
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::string> rows, RowsOf(file));
  // In a run without a date, Times may stay at zero while XTIME counts the minutes.
  const bool no_date = std::ranges::any_of(rows, HasZeroDate);
  absl::StatusOr<std::vector<absl::Time>> times =
      rows.empty() || no_date ? CountedTimes(file, layout) : WrittenTimes(file, rows);
  if (no_date && !times.ok()) times = WrittenTimes(file, rows);
  THUNDERHEAD_ASSIGN_OR_RETURN(read.times, std::move(times));
  if (read.times.size() != layout.records) {
    return absl::DataLossError(absl::StrCat(
        file.Path(), ": has ", read.times.size(), " times, but ", layout.records,
        " records of its variables", layout.time.empty() ? ", which have no dimension of time" : "",
        "; write the file again"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(ReadStart(file, "SIMULATION_START_DATE").status());
  read.run = file.TextOrEmpty("", "SIMULATION_START_DATE");
  if (no_date || HasZeroDate(read.run)) {
    read.run = WithFirstDate(read.run);
    read.assumptions.push_back(
        absl::StrCat("The run has the date ", kZeroDate, ", which is taken as ", kFirstDate, "."));
  }
  return read;
}

}  // namespace thunderhead::storm_files
