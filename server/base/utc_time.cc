#include "base/utc_time.h"

namespace thunderhead::base {

std::optional<absl::Time> ParseUtcTime(const std::string& text) {
  static const absl::Time kFirst = absl::FromCivil(absl::CivilYear(0), absl::UTCTimeZone());
  static const absl::Time kEnd = absl::FromCivil(absl::CivilYear(10'000), absl::UTCTimeZone());
  absl::Time time;
  std::string why;
  if (!absl::ParseTime(absl::RFC3339_full, text, &time, &why)) return std::nullopt;
  return time >= kFirst && time < kEnd ? std::optional(time) : std::nullopt;
}

}  // namespace thunderhead::base
