#include "physics/sun_position.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"

namespace thunderhead::physics {
namespace {

constexpr double kHour_s = 3600.0;
constexpr double kDay_s = 86400.0;

// Returns the seconds since 1970 of a Gregorian date. It computes days from the civil calendar by
// counting leap years.
double Unix_s(int year, int month, int day, double hours) {
  const int shifted = year - (month <= 2 ? 1 : 0);
  const int since_march = (month + 9) % 12;
  const double days = 365.0 * shifted + std::floor(shifted / 4.0) - std::floor(shifted / 100.0) +
                      std::floor(shifted / 400.0) + std::floor((153.0 * since_march + 2.0) / 5.0) +
                      day - 1 - 719468;
  return days * kDay_s + hours * kHour_s;
}

// At the pole the sun's elevation is its declination.
double Declination_deg(double unix_s) { return SunPositionAt(unix_s, 90.0, 0.0).elevation_deg; }

TEST(SunPosition, PublishedAlmanacPlaces) {
  // The example is Meeus, 25.a: 1992 October 13, 0 h.
  EXPECT_NEAR(Declination_deg(Unix_s(1992, 10, 13, 0.0)), -7.785, 0.01);
  // This is the worked example of NREL's Solar Position Algorithm (Reda and Andreas 2004, table
  // A5.1), with its elevation before refraction. The parallax of 0.002 degrees is not in our model.
  const SunPosition golden =
      SunPositionAt(Unix_s(2003, 10, 17, 19.0 + 30.5 / 60.0), 39.742476, -105.1786);
  EXPECT_NEAR(golden.azimuth_deg, 194.34024, 0.01);
  EXPECT_NEAR(golden.elevation_deg, 39.87205, 0.01);
}

TEST(SunPosition, EquinoxesAndSolstices) {
  // The times are accurate to the minute: USNO, Earth's Seasons. The declination at the equinox
  // changes by 0.016 degrees an hour.
  EXPECT_NEAR(Declination_deg(Unix_s(2013, 3, 20, 11.0 + 2.0 / 60.0)), 0.0, 0.01);
  EXPECT_NEAR(Declination_deg(Unix_s(2013, 9, 22, 20.0 + 44.0 / 60.0)), 0.0, 0.01);
  EXPECT_NEAR(Declination_deg(Unix_s(2013, 6, 21, 5.0 + 4.0 / 60.0)), 23.437, 0.01);
  EXPECT_NEAR(Declination_deg(Unix_s(2013, 12, 21, 17.0 + 11.0 / 60.0)), -23.437, 0.01);
}

TEST(SunPosition, EquationOfTime) {
  // At its extremes the sun passes Greenwich's meridian 14 min 14 s late (11 February) and 16 min
  // 26 s early (3 November). A minute is a quarter of a degree.
  const double late = Unix_s(2013, 2, 11, 12.0) + 14.0 * 60.0 + 14.0;
  EXPECT_NEAR(SunPositionAt(late, 51.5, 0.0).azimuth_deg, 180.0, 0.05);
  const double early = Unix_s(2013, 11, 3, 12.0) - 16.0 * 60.0 - 26.0;
  EXPECT_NEAR(SunPositionAt(early, 51.5, 0.0).azimuth_deg, 180.0, 0.05);
}

TEST(SunPosition, NoonAtTheEquinoxStandsAsHighAsTheColatitude) {
  for (const double latitude_deg : {-60.0, 0.0, 35.0, 89.0}) {
    double highest_deg = -90.0;
    for (int minute = 0; minute < 24 * 60; ++minute) {
      const double unix_s = Unix_s(2013, 3, 20, 0.0) + minute * 60.0;
      highest_deg = std::max(highest_deg, SunPositionAt(unix_s, latitude_deg, 30.0).elevation_deg);
    }
    // Within 12 hours of the equinox the declination reaches 0.2 degrees.
    EXPECT_NEAR(highest_deg, 90.0 - std::abs(latitude_deg), 0.25);
  }
}

TEST(SunPosition, RisesInTheEastAndSetsInTheWest) {
  const double equinox = Unix_s(2013, 3, 20, 0.0);
  EXPECT_NEAR(SunPositionAt(equinox + 6 * kHour_s, 0.0, 0.0).azimuth_deg, 90.0, 1.0);
  EXPECT_NEAR(SunPositionAt(equinox + 18 * kHour_s, 0.0, 0.0).azimuth_deg, 270.0, 1.0);
  // 90 degrees west, solar time is 6 hours earlier. The sun itself has moved for a quarter of a
  // day, by less than 0.15 degrees relative to the equator.
  const SunPosition here = SunPositionAt(equinox + 15 * kHour_s, 35.0, 0.0);
  const SunPosition west = SunPositionAt(equinox + 21 * kHour_s, 35.0, -90.0);
  EXPECT_NEAR(here.elevation_deg, west.elevation_deg, 0.15);
  EXPECT_NEAR(here.azimuth_deg, west.azimuth_deg, 0.15);
}

TEST(SunPosition, PolarDayAndNight) {
  for (int hour = 0; hour < 24; ++hour) {
    EXPECT_GT(SunPositionAt(Unix_s(2013, 6, 21, hour), 70.0, 20.0).elevation_deg, 3.0) << hour;
    EXPECT_LT(SunPositionAt(Unix_s(2013, 12, 21, hour), 70.0, 20.0).elevation_deg, -3.0) << hour;
  }
}

TEST(SunPosition, IsFiniteEverywhere) {
  for (const double latitude_deg : {-90.0, 0.0, 90.0}) {
    for (const double unix_s : {-6.2e10, 0.0, 2.5e11}) {
      const SunPosition sun = SunPositionAt(unix_s, latitude_deg, 180.0);
      EXPECT_TRUE(sun.azimuth_deg >= 0.0 && sun.azimuth_deg <= 360.0);
      EXPECT_TRUE(sun.elevation_deg >= -90.0 && sun.elevation_deg <= 90.0);
    }
  }
}

}  // namespace
}  // namespace thunderhead::physics
