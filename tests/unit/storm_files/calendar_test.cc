// Tests of the calendars of CF. The dates and numbers of days were computed with cftime.
#include "storm_files/calendar.h"

#include <gtest/gtest.h>

#include <cmath>

#include "storm_files/cf_times.h"
#include "storm_files/date_time.h"

namespace thunderhead::storm_files {
namespace {

TEST(Calendars, DatesAndDaysAreInverse) {
  for (const Calendar calendar : {Calendar::kStandard, Calendar::kGregorian, Calendar::kJulian,
                                  Calendar::kNoLeap, Calendar::kAllLeap, Calendar::k360Day}) {
    const std::int64_t first = *DayNumber(calendar, {1582, 1, 1});
    const std::int64_t end = *DayNumber(calendar, {1601, 1, 1});
    for (std::int64_t day = first; day < end; ++day) {
      EXPECT_EQ(DayNumber(calendar, DateOf(calendar, day)), day) << NameOf(calendar);
    }
  }
}

TEST(Calendars, HaveTheirOwnDays) {
  EXPECT_FALSE(DayNumber(Calendar::kStandard, {1582, 10, 10}).has_value());
  EXPECT_TRUE(DayNumber(Calendar::kGregorian, {1582, 10, 10}).has_value());
  EXPECT_EQ(*DayNumber(Calendar::kStandard, {1582, 10, 15}),
            *DayNumber(Calendar::kStandard, {1582, 10, 4}) + 1);
  EXPECT_TRUE(DayNumber(Calendar::k360Day, {2013, 2, 30}).has_value());
  EXPECT_FALSE(DayNumber(Calendar::k360Day, {2013, 1, 31}).has_value());
  EXPECT_FALSE(DayNumber(Calendar::kNoLeap, {2012, 2, 29}).has_value());
  EXPECT_TRUE(DayNumber(Calendar::kAllLeap, {2013, 2, 29}).has_value());
  EXPECT_TRUE(DayNumber(Calendar::kJulian, {1900, 2, 29}).has_value());
  EXPECT_FALSE(DayNumber(Calendar::kGregorian, {1900, 2, 29}).has_value());
  EXPECT_FALSE(DayNumber(Calendar::kStandard, {0, 1, 1}).has_value());
  EXPECT_EQ(*DayNumber(Calendar::kJulian, {-4713, 1, 1}), 0);
  EXPECT_FALSE(CalendarOf("mayan").has_value());
  EXPECT_EQ(CalendarOf("NoLeap"), Calendar::kNoLeap);
  EXPECT_EQ(CalendarOf(""), Calendar::kStandard);
}

// The number of days need not be exact, so times are rounded to milliseconds.
TEST(CfTimes, AreRoundedToMilliseconds) {
  const auto times =
      DecodeCfTimes({41384.833333333336, 41384.875}, "days since 1900-01-01", "noleap");
  ASSERT_TRUE(times.ok()) << times.status();
  EXPECT_EQ((*times)[1] - (*times)[0], absl::Hours(1));
}

TEST(CfTimes, OffsetsFromUtcAreApplied) {
  const absl::Time expected =
      absl::FromCivil(absl::CivilSecond(2013, 5, 20, 20), absl::UTCTimeZone());
  for (const char* units :
       {"hours since 2013-05-21 03:00:00 +09:00", "hours since 2013-05-20T12:00:00-06:00",
        "hours since 2013-05-20T18:00:00Z", "hours since 2013-05-20 18:00:00 0:00",
        "hours since 20130520T18"}) {
    const auto times = DecodeCfTimes({2.0}, units, "");
    ASSERT_TRUE(times.ok()) << units << times.status();
    EXPECT_EQ((*times)[0], expected) << units;
  }
}

TEST(CfTimes, FarTimesAreRefused) {
  EXPECT_FALSE(DecodeCfTimes({1e300}, "days since 2013-05-20", "").ok());
  EXPECT_FALSE(DecodeCfTimes({-1.0}, "day as %Y%m%d.%f", "").ok());
  EXPECT_FALSE(DecodeCfTimes({1e12}, "day as %Y%m%d.%f", "").ok());
}

// The words are those of UDUNITS for "since".
TEST(CfTimes, OtherWordsForSinceAreRead) {
  for (const char* units : {"hours since 2013-05-20 12:00", "hours after 2013-05-20 12:00",
                            "Hours FROM 2013-05-20 12:00", "hours ref 2013-05-20 12:00",
                            "hours @ 2013-05-20 12:00", "hours@2013-05-20 12:00"}) {
    const auto times = DecodeCfTimes({8.0}, units, "");
    ASSERT_TRUE(times.ok()) << times.status();
    EXPECT_EQ(absl::FormatTime((*times)[0], absl::UTCTimeZone()), "2013-05-20T20:00:00+00:00");
  }
  EXPECT_EQ(WithSince("m from the ground"), "m from the ground");
  EXPECT_FALSE(DecodeCfTimes({8.0}, "hours after the start", "").ok());
}

}  // namespace
}  // namespace thunderhead::storm_files
