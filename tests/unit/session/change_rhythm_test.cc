// Tests of the expected pause between the changes of a gesture.
#include "session/change_rhythm.h"

#include "gtest/gtest.h"

namespace thunderhead::session {
namespace {

using std::chrono::milliseconds;

TEST(ChangeRhythmTest, ThePauseIsTheLongestRecentOneUntilTheGestureEnds) {
  ChangeRhythm rhythm;
  ChangeRhythm::Time now;
  const auto after = [&](int ms) {
    now += milliseconds(ms);
    return std::chrono::duration_cast<milliseconds>(rhythm.Changed(now)).count();
  };
  EXPECT_EQ(after(0), 0);
  EXPECT_EQ(after(40), 40);
  EXPECT_EQ(after(200), 200);
  // Three quarters of the longest pause, and a quarter of the new one.
  EXPECT_EQ(after(40), 160);
  EXPECT_EQ(after(40), 130);
  EXPECT_EQ(after(701), 0) << "another gesture";
  EXPECT_EQ(after(50), 50);
}

}  // namespace
}  // namespace thunderhead::session
