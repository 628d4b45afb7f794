#include "desktop/texts.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace thunderhead::desktop {
namespace {

// The parts of a valid time, in UTC.
struct Moment {
  int year = 0;
  int month = 0;
  int day = 0;
  int hour = 0;
  int minute = 0;
  int second = 0;

  // Idealised runs begin in year 1.
  bool IsIdealised() const { return year < 100; }
  // Returns the seconds since an arbitrary instant, for differences.
  double Seconds() const {
    const std::chrono::sys_days date =
        std::chrono::year(year) / month / std::chrono::day(static_cast<unsigned>(day));
    const std::chrono::seconds clock =
        std::chrono::hours(hour) + std::chrono::minutes(minute) + std::chrono::seconds(second);
    return static_cast<double>((date.time_since_epoch() + clock) / std::chrono::seconds(1));
  }
};

// Parses a valid time. Returns nothing if the text is not a time.
std::optional<Moment> MomentOf(const std::string& valid_time) {
  Moment moment;
  const int read =
      std::sscanf(valid_time.c_str(), "%d-%d-%d%*1[T_ ]%d:%d:%d", &moment.year, &moment.month,
                  &moment.day, &moment.hour, &moment.minute, &moment.second);
  return read < 5 ? std::nullopt : std::optional(moment);
}

std::string DateOf(const Moment& moment) {
  return absl::StrFormat("%04d-%02d-%02d", moment.year, moment.month, moment.day);
}

// Returns a text like "20:00", with the seconds if they are not 0.
std::string ClockOf(const Moment& moment) {
  const std::string seconds = moment.second > 0 ? absl::StrFormat(":%02d", moment.second) : "";
  return absl::StrFormat("%02d:%02d%s", moment.hour, moment.minute, seconds);
}

}  // namespace

DisplayUnit DisplayUnitOf(const client::Limits& limits) {
  if (limits.unit == "m" && limits.maximum <= 1.0) return {1e3, "mm"};
  if (limits.unit == "m" && limits.maximum >= 1e5) return {1e-3, "km"};
  if (limits.unit == "1") return {1.0, ""};
  if (limits.unit == "deg") return {1.0, "°"};
  if (limits.unit == "kg/m3") return {1.0, "kg/m³"};
  return {1.0, limits.unit};
}

std::string FormatNumber(double value) {
  if (!std::isfinite(value)) return "–";
  const double magnitude = std::abs(value);
  if (magnitude == 0.0) return "0";
  if (magnitude >= 1e6 || magnitude < 1e-4) return absl::StrFormat("%.2e", value);
  if (magnitude >= 100.0) return absl::StrFormat("%.0f", value);
  const int decimals = std::max(0, 2 - static_cast<int>(std::floor(std::log10(magnitude))));
  std::string text = absl::StrFormat("%.*f", decimals, value);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

std::string FormatQuantity(double value, const client::Limits& limits) {
  const DisplayUnit unit = DisplayUnitOf(limits);
  const bool close = unit.symbol.empty() || unit.symbol == "°";
  return absl::StrCat(FormatNumber(value * unit.factor), close ? "" : " ", unit.symbol);
}

std::string FormatPercent(double share) { return FormatNumber(100.0 * share) + " %"; }

std::string FormatLength(double length_m) {
  if (std::abs(length_m) < 1000.0) return FormatNumber(length_m) + " m";
  return FormatNumber(length_m / 1000.0) + " km";
}

std::string FormatBytes(double bytes) {
  constexpr std::array<const char*, 4> kSteps{"B", "kB", "MB", "GB"};
  std::size_t step = 0;
  while (bytes >= 999.5 && step + 1 < kSteps.size()) {
    bytes /= 1000.0;
    ++step;
  }
  return absl::StrCat(FormatNumber(bytes), " ", kSteps.at(step));
}

std::string FormatBitRate(double bytes_per_s) {
  const double kbit = bytes_per_s * 8.0 / 1000.0;
  if (kbit >= 999.5) return FormatNumber(kbit / 1000.0) + " Mbit/s";
  return absl::StrFormat("%.0f kbit/s", kbit);
}

std::string CutTo(std::string text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return text;
  const auto begins_character = [&](std::size_t at) {
    return (static_cast<unsigned char>(text[at]) & 0xC0U) != 0x80U;
  };
  std::size_t end = most_bytes;
  while (end > 0 && !begins_character(end)) --end;
  text.resize(end);
  return text;
}

std::string FormatValidTime(const v1::StormTime& time) {
  const auto moment = MomentOf(time.valid_time());
  if (!moment) {
    return time.valid_time().empty() ? FormatElapsed(time.elapsed_s()) : time.valid_time();
  }
  const std::string clock = ClockOf(*moment);
  if (moment->IsIdealised()) return absl::StrFormat("day %d, %s", moment->day, clock);
  return absl::StrFormat("%s %s UTC", DateOf(*moment), clock);
}

std::string NameOfRun(const v1::StormDescription& storm) {
  if (storm.run_start().empty()) return "";
  const auto moment = MomentOf(storm.run_start());
  if (!moment) return "run " + storm.run_start();
  const std::string date = moment->IsIdealised() ? "" : DateOf(*moment) + " ";
  return absl::StrCat("run ", date, ClockOf(*moment), "Z");
}

double LeadSeconds(const v1::StormDescription& storm, const v1::StormTime& time) {
  if (time.has_lead_s()) return time.lead_s();
  const auto start = MomentOf(storm.run_start());
  const auto valid = MomentOf(time.valid_time());
  return start && valid ? valid->Seconds() - start->Seconds() : time.elapsed_s();
}

std::string FormatElapsed(double elapsed_s) {
  const auto minutes = static_cast<int>(std::floor(elapsed_s / 60.0));
  const auto seconds = static_cast<int>(std::lround(elapsed_s - minutes * 60.0));
  const int hours = minutes / 60;
  std::string text = "+";
  const auto add = [&](int count, const char* unit) {
    absl::StrAppend(&text, text.size() > 1 ? " " : "", count, " ", unit);
  };
  if (hours > 0) add(hours, "h");
  if (minutes % 60 > 0 || (hours == 0 && seconds == 0)) add(minutes % 60, "min");
  if (seconds > 0) add(seconds, "s");
  return text;
}

std::string CompassPoint(double azimuth_deg) {
  constexpr std::array<const char*, 16> kPoints{"N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE",
                                                "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"};
  const double sector = 360.0 / static_cast<double>(kPoints.size());
  const auto at = static_cast<std::size_t>(std::lround(client::WrapDegrees(azimuth_deg) / sector));
  return kPoints.at(at % kPoints.size());
}

std::string DescribePose(const client::Pose& pose, double true_north_deg) {
  const auto whole = [](double degrees) {
    return static_cast<int>(std::lround(client::WrapDegrees(degrees))) % 360;
  };
  if (const auto* orbit = std::get_if<client::OrbitPose>(&pose)) {
    return absl::StrFormat("Seen from %s (%d°), %.0f° high, %s away",
                           CompassPoint(orbit->azimuth_deg - true_north_deg),
                           whole(orbit->azimuth_deg - true_north_deg), orbit->elevation_deg,
                           FormatLength(orbit->distance_m));
  }
  if (const auto* spotter = std::get_if<client::SpotterPose>(&pose)) {
    return absl::StrFormat("Looks to %s (%d°), %.0f° up, through a lens of %s mm",
                           CompassPoint(spotter->azimuth_deg - true_north_deg),
                           whole(spotter->azimuth_deg - true_north_deg), spotter->elevation_deg,
                           FormatNumber(spotter->focal_length_mm));
  }
  // True north is not exactly up on most maps, so the text mentions only a difference of half a
  // degree or more.
  const bool turned = std::abs(std::remainder(true_north_deg, 360.0)) >= 0.5;
  return FormatLength(std::get<client::TopDownPose>(pose).width_m) +
         (turned ? " from left to right, the grid's north up" : " from left to right, north up");
}

std::string DescribeSun(const v1::Sun& sun, double true_north_deg) {
  const double height_deg = sun.elevation_deg();
  return absl::StrFormat("The sun is in %s, %.0f° %s",
                         CompassPoint(sun.azimuth_deg() - true_north_deg), std::abs(height_deg),
                         height_deg < 0.0 ? "below the horizon" : "high");
}

std::string NameOf(v1::Hydrometeor hydrometeor) {
  constexpr std::size_t kPrefix = sizeof("HYDROMETEOR_") - 1;
  std::string name = absl::AsciiStrToLower(v1::Hydrometeor_Name(hydrometeor).substr(kPrefix));
  if (!name.empty()) name[0] = absl::ascii_toupper(static_cast<unsigned char>(name[0]));
  return name;
}

std::string NameOf(v1::Preset preset) {
  switch (preset) {
    case v1::PRESET_UNSPECIFIED:
      return "None";
    case v1::PRESET_FAST:
      return "Fast";
    case v1::PRESET_BALANCED:
      return "Balanced";
    case v1::PRESET_ACCURATE:
      return "Accurate";
    case v1::PRESET_UNIFORM_PHASE_LOW_ALBEDO:
      return "Uniform phase, low albedo";
    case v1::PRESET_UNIFORM_PHASE_TRANSLUCENT:
      return "Uniform phase, translucent";
    case v1::PRESET_PER_FIELD_PHASE_TRANSLUCENT:
      return "Phase per field, translucent";
    case v1::PRESET_PER_FIELD_PHASE_DETAIL_TRANSLUCENT:
      return "Phase per field, detail, translucent";
    default:
      return absl::StrCat("Preset ", static_cast<int>(preset));
  }
}

bool IsExtinction(const v1::FieldDescription& field) { return field.units() == "m-1"; }

std::string DescribeAmount(const v1::FieldDescription& field) {
  const char* const unit = IsExtinction(field)         ? "/km"
                           : field.units() == "kg m-3" ? "g/m³"
                                                       : "g/kg";
  return absl::StrCat("up to ", FormatNumber(1000.0 * field.maximum()), " ", unit);
}

std::string ErrorSource(const v1::AccuracyReport& report) {
  if (!report.has_error_low() || !report.has_error_high()) return "from a table, until measured";
  return absl::StrCat("measured: ", FormatNumber(100.0 * report.error_low()), " to ",
                      FormatPercent(report.error_high()));
}

std::string DescribeError(const v1::AccuracyReport& report) {
  const std::string error = FormatPercent(report.estimated_error());
  if (!report.measured()) {
    const std::string slices = report.has_discretisation_error()
                                   ? ", few slices " + FormatPercent(report.discretisation_error())
                                   : "";
    return absl::StrCat("Estimated error ", error, " (light model ",
                        FormatPercent(report.model_error()), slices, ")");
  }
  const std::string bias =
      report.has_bias() ? absl::StrCat(", ", FormatPercent(std::abs(report.bias())), " too ",
                                       report.bias() < 0.0F ? "dark" : "bright", " on the whole")
                        : "";
  return absl::StrCat("Measured error ", error, " (", ErrorSource(report), bias, ")");
}

}  // namespace thunderhead::desktop
