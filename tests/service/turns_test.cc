// Round-robin scheduling, on plain values.
#include "session/turns.h"

#include <map>
#include <set>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::session {
namespace {

using ::testing::ElementsAre;

class TurnsTest : public ::testing::Test {
 protected:
  // The session that uses the next turn; the empty string if none does.
  std::string Serve() {
    std::string served;
    asked_.clear();
    std::vector<Contender> contenders;
    for (const std::string& id : ids_) {
      contenders.push_back({id, id.find('/') != std::string::npos});
    }
    look_again_at_ = turns_.Next(contenders, [&](std::size_t i, TurnKind kind) -> TurnOutcome {
      asked_.push_back(ids_[i]);
      const bool in_background = in_background_.count(ids_[i]) > 0;
      if (busy_.count(ids_[i]) == 0 && !(in_background && kind == TurnKind::kBackground)) {
        return {false, waits_until_[ids_[i]], in_background};
      }
      served = ids_[i];
      return {true, std::nullopt};
    });
    return served;
  }

  Turns turns_;
  std::vector<std::string> ids_{"", "a", "b", "c"};
  std::set<std::string> busy_;
  std::set<std::string> in_background_;  // who have background work
  std::map<std::string, std::optional<Clock::time_point>> waits_until_;
  std::vector<std::string> asked_;
  std::optional<Clock::time_point> look_again_at_;
};

TEST_F(TurnsTest, AllWhoHaveWorkAreServedInTurn) {
  busy_ = {"", "a", "c"};
  std::vector<std::string> served;
  for (int i = 0; i < 6; ++i) served.push_back(Serve());
  EXPECT_THAT(served, ElementsAre("a", "c", "", "a", "c", ""));
}

TEST_F(TurnsTest, OwnViewsTogetherTakeHalfOfTheTurns) {
  ids_ = {"", "a", "a/1", "a/2", "a/3", "b"};
  busy_ = {"a", "a/1", "a/2", "a/3", "b"};
  std::vector<std::string> served;
  for (int i = 0; i < 8; ++i) served.push_back(Serve());
  EXPECT_THAT(served, ElementsAre("a", "a/1", "b", "a/2", "a", "a/3", "b", "a/1"));
}

TEST_F(TurnsTest, OwnViewsTakeEveryTurnThatNobodyElseUses) {
  ids_ = {"", "a", "a/1", "a/2"};
  busy_ = {"a/1", "a/2"};
  std::vector<std::string> served;
  for (int i = 0; i < 3; ++i) served.push_back(Serve());
  EXPECT_THAT(served, ElementsAre("a/1", "a/2", "a/1"));
}

TEST_F(TurnsTest, TheRoundGoesOnWhereTheLastServedHasGone) {
  busy_ = {"a", "b", "c"};
  EXPECT_EQ(Serve(), "a");
  EXPECT_EQ(Serve(), "b");
  ids_ = {"", "a", "c"};
  EXPECT_EQ(Serve(), "c");
  EXPECT_EQ(Serve(), "a");
}

TEST_F(TurnsTest, ATurnThatIsUsedEndsTheRoundAndItGoesOnAtOnce) {
  busy_ = {"b"};
  const Clock::time_point before = Clock::now();
  EXPECT_EQ(Serve(), "b");
  EXPECT_THAT(asked_, ElementsAre("a", "b"));
  EXPECT_GE(*look_again_at_, before);
}

TEST_F(TurnsTest, BackgroundWorkIsDoneInTurnWhileNothingElseIs) {
  in_background_ = {"a", "c"};
  std::vector<std::string> served;
  for (int i = 0; i < 4; ++i) served.push_back(Serve());
  EXPECT_THAT(served, ElementsAre("a", "c", "a", "c"));
}

TEST_F(TurnsTest, BackgroundWorkDoesNotComeBetweenAnothersFrames) {
  in_background_ = {"a"};
  busy_ = {"b"};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(Serve(), "b");
  busy_.clear();
  const Clock::time_point drew_at = Clock::now();
  EXPECT_EQ(Serve(), "") << "it may draw again at once";
  ASSERT_TRUE(look_again_at_.has_value());
  EXPECT_LE(*look_again_at_, drew_at + kQuietBeforeBackground);
  std::this_thread::sleep_until(*look_again_at_);
  EXPECT_EQ(Serve(), "a");
}

TEST_F(TurnsTest, WithoutWorkTheEarliestWishCounts) {
  EXPECT_EQ(Serve(), "");
  EXPECT_FALSE(look_again_at_.has_value());
  const Clock::time_point early{std::chrono::seconds(1)};
  waits_until_ = {{"a", early + std::chrono::seconds(1)}, {"b", early}};
  EXPECT_EQ(Serve(), "");
  EXPECT_EQ(asked_.size(), ids_.size());
  EXPECT_EQ(look_again_at_, early);
}

}  // namespace
}  // namespace thunderhead::session
