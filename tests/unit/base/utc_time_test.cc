#include "base/utc_time.h"

#include <gtest/gtest.h>

namespace thunderhead::base {
namespace {

absl::Time At(int year, int month, int day, int hour, int minute, int second) {
  return absl::FromCivil(absl::CivilSecond(year, month, day, hour, minute, second),
                         absl::UTCTimeZone());
}

TEST(UtcTime, IsReadWithItsOffset) {
  EXPECT_EQ(ParseUtcTime("2013-05-20T20:00:00Z"), At(2013, 5, 20, 20, 0, 0));
  EXPECT_EQ(ParseUtcTime("2013-05-20T20:00:00+05:30"), At(2013, 5, 20, 14, 30, 0));
  EXPECT_EQ(ParseUtcTime("2013-05-20T20:00:00-06:00"), At(2013, 5, 21, 2, 0, 0));
  EXPECT_EQ(ParseUtcTime("2012-02-29T00:00:00.5Z"),
            At(2012, 2, 29, 0, 0, 0) + absl::Milliseconds(500));
  EXPECT_EQ(ParseUtcTime("0001-01-01T00:20:00Z"), At(1, 1, 1, 0, 20, 0));
}

TEST(UtcTime, OtherTextsAreNone) {
  for (const char* text :
       {"", "noon", "2013-05-20", "2013-05-20T20:00:00", "2013-13-20T20:00:00Z",
        "2013-02-29T20:00:00Z", "2013-04-31T20:00:00Z", "2013-00-20T20:00:00Z",
        "2013-05-20T24:00:00Z", "2013-05-20T99:99:99Z", "2013-05-20T20:60:00Z",
        "2013-05-20T20:00:00+9999", "2013-05-20T20:00:00+99:99", "2013-05-20T20:00:00Zulu",
        "infinite-future", "infinite-past", "20130-05-20T20:00:00Z", "-0001-05-20T20:00:00Z"}) {
    EXPECT_FALSE(ParseUtcTime(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace thunderhead::base
