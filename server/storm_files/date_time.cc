#include "storm_files/date_time.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/strip.h"

namespace thunderhead::storm_files {
namespace {

// The largest offset from UTC of any time zone on Earth, in hours.
constexpr int kMaxOffsetHours = 14;

struct UnitOfTime {
  absl::string_view name;
  double seconds;
};

// The spellings of CF and UDUNITS.
constexpr std::array kUnitsOfTime = {
    UnitOfTime{"s", 1.0},        UnitOfTime{"sec", 1.0},       UnitOfTime{"secs", 1.0},
    UnitOfTime{"second", 1.0},   UnitOfTime{"seconds", 1.0},   UnitOfTime{"min", 60.0},
    UnitOfTime{"mins", 60.0},    UnitOfTime{"minute", 60.0},   UnitOfTime{"minutes", 60.0},
    UnitOfTime{"h", 3600.0},     UnitOfTime{"hr", 3600.0},     UnitOfTime{"hrs", 3600.0},
    UnitOfTime{"hour", 3600.0},  UnitOfTime{"hours", 3600.0},  UnitOfTime{"d", 86'400.0},
    UnitOfTime{"day", 86'400.0}, UnitOfTime{"days", 86'400.0},
};

// Reads a text from its beginning. A part that does not match is not consumed.
class Scanner {
 public:
  explicit Scanner(absl::string_view text) : rest_(text) {}

  bool AtEnd() const { return rest_.empty(); }

  bool Take(absl::string_view word) {
    if (!absl::StartsWithIgnoreCase(rest_, word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }

  bool TakeBlanks() {
    const std::size_t before = rest_.size();
    rest_ = absl::StripLeadingAsciiWhitespace(rest_);
    return rest_.size() < before;
  }

  // Takes all digits that follow. Takes nothing if there are none or more than `max_digits`.
  std::optional<int> TakeNumber(std::size_t max_digits) {
    const std::size_t digits = Digits();
    if (digits == 0 || digits > max_digits) return std::nullopt;
    int number = 0;
    for (const char digit : rest_.substr(0, digits)) number = 10 * number + (digit - '0');
    rest_.remove_prefix(digits);
    return number;
  }

  // Takes a decimal point and the digits after it. Returns 0 if there is none.
  double TakeFraction() {
    double fraction = 0.0;
    if (!Take(".")) return fraction;
    const std::size_t digits = Digits();
    double place = 0.1;
    for (const char digit : rest_.substr(0, digits)) {
      fraction += place * (digit - '0');
      place *= 0.1;
    }
    rest_.remove_prefix(digits);
    return fraction;
  }

  std::size_t Digits() const {
    const auto end = std::ranges::find_if_not(rest_, absl::ascii_isdigit);
    return static_cast<std::size_t>(end - rest_.begin());
  }

 private:
  absl::string_view rest_;
};

// Takes a date of any calendar: "2013-5-20", "-4713-01-01" or "20130520".
std::optional<WrittenDate> TakeDate(Scanner& text) {
  if (constexpr std::size_t kCompact = 8; text.Digits() == kCompact) {
    const int number = *text.TakeNumber(kCompact);
    return WrittenDate{number / 10'000, number / 100 % 100, number % 100, {}};
  }
  const bool before_christ = text.Take("-");
  const std::optional<int> year = text.TakeNumber(4);
  if (!year.has_value() || !text.Take("-")) return std::nullopt;
  const std::optional<int> month = text.TakeNumber(2);
  if (!month.has_value() || !text.Take("-")) return std::nullopt;
  const std::optional<int> day = text.TakeNumber(2);
  if (!day.has_value()) return std::nullopt;
  return WrittenDate{before_christ ? -*year : *year, *month, *day, {}};
}

// Takes a time of day: "18", "18:00" or "18:00:00.5", and if `compact` also "1800".
std::optional<absl::Duration> TakeTimeOfDay(Scanner& text, bool compact) {
  if (compact && text.Digits() == 4) {
    const int number = *text.TakeNumber(4);
    if (number / 100 > 23 || number % 100 > 59) return std::nullopt;
    return absl::Hours(number / 100) + absl::Minutes(number % 100);
  }
  const std::optional<int> hour = text.TakeNumber(2);
  if (!hour.has_value() || *hour > 23) return std::nullopt;
  absl::Duration time = absl::Hours(*hour);
  if (!text.Take(":")) return time;
  const std::optional<int> minute = text.TakeNumber(2);
  if (!minute.has_value() || *minute > 59) return std::nullopt;
  time += absl::Minutes(*minute);
  if (!text.Take(":")) return time;
  const std::optional<int> second = text.TakeNumber(2);
  if (!second.has_value() || *second > 59) return std::nullopt;
  return time + absl::Seconds(*second) + absl::Seconds(text.TakeFraction());
}

// Takes the offset from UTC after its sign: "6", "05", "5:30", "05:30" or "0530".
std::optional<absl::Duration> TakeOffset(Scanner& text) {
  const std::size_t digits = text.Digits();
  if (digits == 3) return std::nullopt;  // "530" is ambiguous: 5:30 or 53:0
  std::optional<int> hours = text.TakeNumber(4);
  if (!hours.has_value()) return std::nullopt;
  std::optional<int> minutes = 0;
  if (digits == 4) {
    minutes = *hours % 100;
    *hours /= 100;
  } else if (text.Take(":")) {
    minutes = text.Digits() == 2 ? text.TakeNumber(2) : std::nullopt;
  }
  if (!minutes.has_value() || *minutes > 59) return std::nullopt;
  const absl::Duration offset = absl::Hours(*hours) + absl::Minutes(*minutes);
  if (offset > absl::Hours(kMaxOffsetHours)) return std::nullopt;
  return offset;
}

// Parses a date, in the stricter form of models or in every form of UDUNITS.
std::optional<WrittenDate> ParseForm(std::string_view text, bool as_udunits) {
  Scanner scanner(absl::StripAsciiWhitespace(absl::string_view(text.data(), text.size())));
  if (!as_udunits && scanner.Digits() > 4) return std::nullopt;
  std::optional<WrittenDate> date = TakeDate(scanner);
  if (!date.has_value()) return std::nullopt;
  bool has_clock = scanner.Take("T") || scanner.Take("_");
  if (!has_clock && scanner.TakeBlanks()) has_clock = scanner.Digits() > 0;
  bool after_blanks = false;
  if (has_clock) {
    const std::optional<absl::Duration> clock = TakeTimeOfDay(scanner, as_udunits);
    if (!clock.has_value()) return std::nullopt;
    date->since_midnight = *clock;
    after_blanks = scanner.TakeBlanks();
  }
  // An offset without a sign is eastern, as in UDUNITS.
  const bool no_sign = as_udunits && after_blanks && scanner.Digits() > 0;
  const bool east = has_clock && (scanner.Take("+") || no_sign);
  if (east || (has_clock && scanner.Take("-"))) {
    const std::optional<absl::Duration> offset = TakeOffset(scanner);
    if (!offset.has_value()) return std::nullopt;
    date->since_midnight -= east ? *offset : -*offset;
  } else if (!scanner.Take("UTC") && !scanner.Take("GMT")) {
    scanner.Take("Z");
  }
  return scanner.AtEnd() ? date : std::nullopt;
}

}  // namespace

std::optional<WrittenDate> ParseWrittenDate(std::string_view text) { return ParseForm(text, true); }

std::optional<absl::Time> ParseDateTime(std::string_view text) {
  const std::optional<WrittenDate> written = ParseForm(text, false);
  if (!written.has_value() || written->year < 0) return std::nullopt;
  const absl::CivilDay date(written->year, written->month, written->day);
  // CivilDay turns a day that does not exist into another day.
  if (date.month() != written->month || date.day() != written->day) return std::nullopt;
  return absl::FromCivil(absl::CivilSecond(date), absl::UTCTimeZone()) + written->since_midnight;
}

absl::Time StartWithoutDate() {
  return absl::FromCivil(absl::CivilSecond(1, 1, 1), absl::UTCTimeZone());
}

std::string WithSince(std::string_view units) {
  std::string text(units);
  const std::string lower = absl::AsciiStrToLower(text);
  for (const char* const word : {" after ", " from ", " ref ", "@"}) {
    const std::size_t at = lower.find(word);
    if (at == std::string::npos) continue;
    const std::string date(
        absl::StripAsciiWhitespace(text.substr(at + std::string_view(word).size())));
    if (!ParseWrittenDate(date).has_value()) continue;
    return text.substr(0, at) + " since " + date;
  }
  return text;
}

std::optional<TimeUnits> ParseTimeUnits(std::string_view units) {
  constexpr absl::string_view kSince = " since ";
  const std::string text = absl::AsciiStrToLower(WithSince(units));
  const std::size_t since = text.find(std::string(kSince));
  const absl::string_view name =
      absl::StripAsciiWhitespace(absl::string_view(text).substr(0, since));
  const auto unit = std::ranges::find(kUnitsOfTime, name, &UnitOfTime::name);
  if (unit == kUnitsOfTime.end()) return std::nullopt;
  TimeUnits parsed{unit->seconds, std::nullopt};
  if (since == std::string::npos) return parsed;
  parsed.origin = ParseDateTime(std::string_view(text).substr(since + kSince.size()));
  return parsed.origin.has_value() ? std::optional(parsed) : std::nullopt;
}

}  // namespace thunderhead::storm_files
