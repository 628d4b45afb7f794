// Tests of dates and units of time: each is read correctly or refused.
#include "storm_files/date_time.h"

#include <gtest/gtest.h>

#include <string>

namespace thunderhead::storm_files {
namespace {

absl::Time At(int year, int month, int day, int hour = 0, int minute = 0, int second = 0) {
  return absl::FromCivil(absl::CivilSecond(year, month, day, hour, minute, second),
                         absl::UTCTimeZone());
}

TEST(ParseDateTime, ReadsDatesAndTimesOfDay) {
  const absl::Time evening = At(2013, 5, 20, 18, 30, 15);
  for (const char* text :
       {"2013-05-20_18:30:15", "2013-05-20T18:30:15", "2013-05-20 18:30:15", "2013-5-20 18:30:15",
        "2013-05-20   18:30:15.0", " 2013-05-20 18:30:15. ", "2013-05-20t18:30:15"}) {
    EXPECT_EQ(ParseDateTime(text), evening) << text;
  }
  EXPECT_EQ(ParseDateTime("2013-05-20"), At(2013, 5, 20));
  EXPECT_EQ(ParseDateTime("2013-05-20 18"), At(2013, 5, 20, 18));
  EXPECT_EQ(ParseDateTime("2013-05-20 6:5"), At(2013, 5, 20, 6, 5));
  EXPECT_EQ(ParseDateTime("1-1-1 00:00:0.0"), At(1, 1, 1));
  EXPECT_EQ(ParseDateTime("0001-01-01_00:00:00"), At(1, 1, 1));
  EXPECT_EQ(ParseDateTime("9999-12-31 23:59:59"), At(9999, 12, 31, 23, 59, 59));
  EXPECT_EQ(ParseDateTime("2013-05-20 18:30:15.25"), evening + absl::Milliseconds(250));
}

TEST(ParseDateTime, KnowsLeapYears) {
  EXPECT_EQ(ParseDateTime("2012-02-29"), At(2012, 2, 29));
  EXPECT_EQ(ParseDateTime("2000-02-29_12:00:00"), At(2000, 2, 29, 12));
  for (const char* text : {"2013-02-29", "1900-02-29", "2100-02-29", "2012-02-30"}) {
    EXPECT_FALSE(ParseDateTime(text).has_value()) << text;
  }
}

// A place six hours west of UTC has an earlier local time.
TEST(ParseDateTime, TakesOffsetsFromUtcOff) {
  const absl::Time noon = At(2013, 5, 20, 12);
  for (const char* text :
       {"2013-05-20 12:00:00Z", "2013-05-20 12:00:00 UTC", "2013-05-20 12:00:00 utc",
        "2013-05-20 12:00 GMT", "2013-05-20 12:00:00 +0", "2013-05-20 12:00:00 +00:00",
        "2013-05-20 17:30:00 +05:30", "2013-05-20T17:30:00+05:30", "2013-05-20 17:30:00 +0530",
        "2013-05-20 17:30:00 +5:30", "2013-05-20 06:00:00 -6", "2013-05-20 06:00:00 -06",
        "2013-05-20 6:00:0.0 -6:00", "2013-05-20T06-06:00", "2013-05-21 02:00:00 +14:00",
        "2013-05-20 02:15:00 -0945"}) {
    EXPECT_EQ(ParseDateTime(text), noon) << text;
  }
  EXPECT_EQ(ParseDateTime("2013-05-20 UTC"), At(2013, 5, 20));
  EXPECT_EQ(ParseDateTime("2013-05-20Z"), At(2013, 5, 20));
}

TEST(ParseDateTime, ReadsNothingElse) {
  for (const char* text :
       {"", " ", "now", "2013", "2013-05", "2013-13-20", "2013-00-20", "2013-05-00", "2013-05-32",
        "2013-04-31", "20130520", "20-05-2013", "05-20-2013", "2013/05/20", "2013-May-20",
        "+2013-05-20", "-2013-05-20", "12013-05-20", "2013-05-20T", "2013-05-20_", "2013-05-20 x",
        "2013-+5-20", "2013- 5-20",
        // Invalid times of day follow. 24:00 must be written as 0:00 of the next day, and the
        // calendars of models have no leap seconds.
        "2013-05-20 24:00:00", "2013-05-20 24:00", "2013-05-20 25:00:00", "2013-05-20 99:99:99",
        "2013-05-20 18:60:00", "2013-05-20 18:00:60", "2016-12-31 23:59:60", "2013-05-20 1800",
        "2013-05-20 18:", "2013-05-20 18:00:", "2013-05-20 -1:00:00", "2013-05-20 18:000:00",
        "2013-05-20 18:00:00:00", "2013-05-20 18:00:00,5", "2013-05-20 6 pm", "2013-05-20 18.5",
        "2013-05-20 18:00:00 noon", "2013-05-20 T18:00:00",
        // Invalid offsets from UTC follow.
        "2013-05-20 18:00:00 +9999", "2013-05-20 18:00:00 +99:99", "2013-05-20 18:00:00 +15:00",
        "2013-05-20 18:00:00 -14:01", "2013-05-20 18:00:00 +05:60", "2013-05-20 18:00:00 +530",
        "2013-05-20 18:00:00 +", "2013-05-20 18:00:00 5:30", "2013-05-20 18:00:00 +05:3",
        "2013-05-20 18:00:00 +05:300", "2013-05-20 18:00:00 +05300", "2013-05-20 18:00:00 CET",
        "2013-05-20 18:00:00 +05:30 UTC", "2013-05-20 +05:30", "2013-05-20+05:30"}) {
    EXPECT_FALSE(ParseDateTime(text).has_value()) << text;
  }
}

TEST(ParseTimeUnits, ReadsTheUnitsOfCf) {
  struct Case {
    const char* units;
    double seconds;
    absl::Time origin;
  };
  const absl::Time evening = At(2013, 5, 20, 18);
  for (const Case& c : {Case{"seconds since 2013-05-20 18:00:00", 1.0, evening},
                        Case{"s since 2013-05-20T18:00:00Z", 1.0, evening},
                        Case{"sec since 2013-05-20 18:00", 1.0, evening},
                        Case{"minutes since 2013-05-20_18:00:00", 60.0, evening},
                        Case{"Minutes Since 2013-05-20 23:30:00 +05:30", 60.0, evening},
                        Case{"min since 2013-5-20 12:00:00 -6:00", 60.0, evening},
                        Case{"hours since 2013-05-20 18", 3600.0, evening},
                        Case{"hr since 2013-05-20 18:00:0.0", 3600.0, evening},
                        Case{"h since 2013-05-20 18:00", 3600.0, evening},
                        Case{"days  since  2013-05-20 18:00", 86400.0, evening},
                        Case{"hours after 2013-05-20 18:00", 3600.0, evening},
                        Case{"d since 1970-01-01", 86400.0, absl::UnixEpoch()}}) {
    const std::optional<TimeUnits> units = ParseTimeUnits(c.units);
    ASSERT_TRUE(units.has_value()) << c.units;
    EXPECT_EQ(units->seconds, c.seconds) << c.units;
    EXPECT_EQ(units->origin, c.origin) << c.units;
  }
  for (const auto& [text, seconds] : {std::pair("s", 1.0), std::pair(" minutes ", 60.0),
                                      std::pair("hours", 3600.0), std::pair("day", 86400.0)}) {
    const std::optional<TimeUnits> units = ParseTimeUnits(text);
    ASSERT_TRUE(units.has_value()) << text;
    EXPECT_EQ(units->seconds, seconds);
    EXPECT_FALSE(units->origin.has_value());
  }
}

TEST(ParseTimeUnits, ReadsNothingElse) {
  for (const char* text : {"",
                           "since 2013-05-20",
                           "months since 2013-05-20",
                           "years since 2013-05-20",
                           "weeks since 2013-05-20",
                           "common_years since 2013-05-20",
                           "minuten since 2013-05-20",
                           "daylight since 2013-05-20",
                           "secant since 2013-05-20",
                           "ms since 2013-05-20",
                           "m since 2013-05-20",
                           "10 minutes since 2013-05-20",
                           "day as %Y%m%d.%f",
                           "seconds till 2013-05-20",
                           "seconds since",
                           "seconds since ",
                           "seconds since then",
                           "seconds since 2013-13-20 18:00:00",
                           "seconds since 2013-05-20 99:99:99",
                           "seconds since 2013-05-20 18:00:00 +9999",
                           "seconds since 2013-05-20 noon",
                           "seconds since 2013-05-20 since 2013-05-21",
                           "(not text)",
                           "1"}) {
    EXPECT_FALSE(ParseTimeUnits(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace thunderhead::storm_files
