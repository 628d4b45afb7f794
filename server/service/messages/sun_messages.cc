#include "service/messages/sun_messages.h"

#include <cmath>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/civil_time.h"
#include "absl/time/time.h"
#include "base/error_details.h"
#include "base/utc_time.h"
#include "physics/sun_position.h"

namespace thunderhead::service {
namespace {

// The default date, an afternoon of the storm season in Oklahoma, for runs without a date and
// place.
constexpr char kStormSeason[] = "2013-05-20T20:00:00Z";
constexpr float kOklahomaLatitude_deg = 35.25F;
constexpr float kOklahomaLongitude_deg = -97.5F;

// Years before this are not real dates, because idealised runs start in year 1.
constexpr int kFirstRealYear = 100;

bool IsReal(const std::string& valid_time) {
  const std::optional<absl::Time> time = base::ParseUtcTime(valid_time);
  return time.has_value() && absl::ToCivilYear(*time, absl::UTCTimeZone()).year() >= kFirstRealYear;
}

bool HasPlace(const storm_store::StormInfo& storm) {
  return storm.latitude_deg.has_value() && storm.longitude_deg.has_value();
}

}  // namespace

absl::Status CheckSun(const v1::Sun& sun) {
  const std::string& text = sun.clock().date_time();
  if (text.empty() || base::ParseUtcTime(text).has_value()) return absl::OkStatus();
  return base::InvalidField(
      "scene.sun.clock.date_time",
      absl::StrCat("is '", text, "'; it must be a date and time like 2013-05-20T20:00:00Z"),
      "DATE_TIME_MALFORMED");
}

void FillSunDefaults(v1::Sun& sun, const storm_store::StormInfo& storm, int time_index) {
  if (sun.source() == v1::Sun::SOURCE_UNSPECIFIED) {
    const bool given = sun.has_azimuth_deg() || sun.has_elevation_deg();
    const bool real = HasPlace(storm) && IsReal(storm.times.front().valid_time);
    sun.set_source(real && !given ? v1::Sun::SOURCE_BY_TIME : v1::Sun::SOURCE_BY_HAND);
  }
  if (sun.source() != v1::Sun::SOURCE_BY_TIME) return;
  v1::SunClock& clock = *sun.mutable_clock();
  FillClockDefaults(clock, storm, time_index);
  const std::optional<absl::Time> first = base::ParseUtcTime(clock.date_time());
  if (!first.has_value()) return;  // CheckSun reports the error
  const double unix_s = absl::ToDoubleSeconds(*first - absl::UnixEpoch()) +
                        storm.times[static_cast<std::size_t>(time_index)].elapsed_s;
  const physics::SunPosition position =
      physics::SunPositionAt(unix_s, clock.latitude_deg(), clock.longitude_deg());
  // The sun's position counts from true north, and the scene's azimuths from the grid's north.
  const double north_deg =
      storm_store::TrueNorthOf_deg(storm, static_cast<std::size_t>(time_index));
  const double azimuth_deg = std::fmod(position.azimuth_deg + north_deg + 360.0, 360.0);
  sun.set_azimuth_deg(static_cast<float>(azimuth_deg));
  sun.set_elevation_deg(static_cast<float>(position.elevation_deg));
}

void FillClockDefaults(v1::SunClock& clock, const storm_store::StormInfo& storm, int time_index) {
  const std::string& first = storm.times.front().valid_time;
  if (clock.date_time().empty()) clock.set_date_time(IsReal(first) ? first : kStormSeason);
  const auto middle = storm_store::MiddleOf(storm, static_cast<std::size_t>(time_index));
  if (!clock.has_latitude_deg()) {
    clock.set_latitude_deg(middle.has_value() ? static_cast<float>(middle->latitude_deg)
                                              : kOklahomaLatitude_deg);
  }
  if (!clock.has_longitude_deg()) {
    clock.set_longitude_deg(middle.has_value() ? static_cast<float>(middle->longitude_deg)
                                               : kOklahomaLongitude_deg);
  }
}

void ToMessage(const scene::Sun& sun, v1::Sun& message) {
  message.set_azimuth_deg(static_cast<float>(sun.azimuth_deg));
  message.set_elevation_deg(static_cast<float>(sun.elevation_deg));
  message.set_irradiance(static_cast<float>(sun.irradiance));
}

}  // namespace thunderhead::service
