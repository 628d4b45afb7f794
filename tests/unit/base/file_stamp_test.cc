#include "base/file_stamp.h"

#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

using std::chrono::duration_cast;
using std::chrono::hours;
using std::chrono::nanoseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

TEST(UnchangedSince, IsTheFilesDateBetweenTheEarliestAndNow) {
  const steady_clock::time_point now = steady_clock::now();
  // Files get their modification times from the system clock.
  const auto wall = std::chrono::system_clock::now();
  const auto date_before = [wall](nanoseconds age) {
    return (duration_cast<nanoseconds>(wall.time_since_epoch()) - age).count();
  };
  const auto age = [&](nanoseconds by_date, steady_clock::time_point earliest) {
    return now - UnchangedSince(date_before(by_date), earliest, now, wall);
  };
  const auto any = steady_clock::time_point::min();
  EXPECT_EQ(age(seconds(5), any), seconds(5));
  EXPECT_GE(age(hours(24 * 365 * 60), any), hours(24 * 300)) << "a date of long ago";
  // The system clock was set back by an hour after the file was written, so the file's age is
  // unknown. After the file has been observed for a second, its age is at least a second.
  EXPECT_EQ(age(-hours(1), any), nanoseconds(0));
  const nanoseconds later =
      now + seconds(1) - UnchangedSince(date_before(-hours(1)), now, now, wall);
  EXPECT_EQ(later, seconds(1));
  // The system clock was set forward, or a copied file kept an old modification time. A file that
  // did not exist at the last check cannot be older than this check.
  EXPECT_EQ(age(hours(1), now - seconds(3)), seconds(3));
}

}  // namespace
}  // namespace thunderhead::base
