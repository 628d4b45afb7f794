// Tests of the choice which contender (session, picture or other work) may draw next.
#include "drawing/turns.h"

#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::drawing {
namespace {

using ::testing::ElementsAre;

class TurnsTest : public ::testing::Test {
 protected:
  // Adds a contender, each of whose turns takes `piece_ms`. An id with a slash is the own view of
  // one person in a session.
  void Busy(const std::string& id, TurnClass turn_class, double piece_ms = 10.0) {
    busy_[id] = {turn_class, piece_ms};
  }

  // Returns the contender that uses the next turn; empty if there is none.
  std::string Serve() {
    std::vector<Contender> contenders;
    for (const std::string& id : ids_) {
      contenders.push_back({id, id.find('/') != std::string::npos, std::nullopt});
      if (busy_.contains(id)) contenders.back().work = busy_[id].turn_class;
    }
    const auto next = turns_.Next(contenders);
    if (!next.has_value()) return "";
    const Contender& served = contenders[*next];
    turns_.Used(served, busy_[served.id].piece_ms);
    used_ms_[served.id] += busy_[served.id].piece_ms;
    return served.id;
  }

  std::vector<std::string> ServeTurns(int count) {
    std::vector<std::string> served;
    for (int i = 0; i < count; ++i) served.push_back(Serve());
    return served;
  }

  // Returns the share of the time that one contender used, until `until_ms` were used in all.
  double ShareOf(const std::string& id, double until_ms) {
    used_ms_.clear();
    double all_ms = 0.0;
    while (all_ms < until_ms) {
      Serve();
      all_ms = std::accumulate(used_ms_.begin(), used_ms_.end(), 0.0,
                               [](double sum, const auto& used) { return sum + used.second; });
    }
    return used_ms_[id] / all_ms;
  }

  struct Work {
    TurnClass turn_class{};
    double piece_ms = 0.0;
  };

  Turns turns_;
  std::vector<std::string> ids_{"a", "b", "c"};
  std::map<std::string, Work> busy_;
  std::map<std::string, double> used_ms_;
};

TEST_F(TurnsTest, AllWhoHaveWorkAreServedInTurn) {
  Busy("a", TurnClass::kInteractive);
  Busy("c", TurnClass::kInteractive);
  EXPECT_THAT(ServeTurns(5), ElementsAre("a", "c", "a", "c", "a"));
  busy_.clear();
  EXPECT_EQ(Serve(), "");
}

TEST_F(TurnsTest, AllGetTheSameTimeHoweverLongTheirPiecesAre) {
  Busy("a", TurnClass::kInteractive, 5.0);
  Busy("b", TurnClass::kInteractive, 50.0);
  Busy("c", TurnClass::kInteractive, 15.0);
  EXPECT_NEAR(ShareOf("a", 1e4), 1.0 / 3.0, 0.01);
  EXPECT_NEAR(ShareOf("b", 1e4), 1.0 / 3.0, 0.01);
}

TEST_F(TurnsTest, WhoComesWaitsForNobodyAndIsOwedNothing) {
  Busy("b", TurnClass::kInteractive);
  ServeTurns(100);
  Busy("a", TurnClass::kInteractive);
  EXPECT_THAT(ServeTurns(4), ElementsAre("a", "b", "a", "b"));
}

TEST_F(TurnsTest, WhoPausesAfterALongTurnIsStillInDebt) {
  Busy("a", TurnClass::kInteractive, 100.0);
  Busy("b", TurnClass::kInteractive, 10.0);
  EXPECT_EQ(Serve(), "a");
  busy_.erase("a");
  EXPECT_EQ(Serve(), "b");
  Busy("a", TurnClass::kInteractive, 100.0);
  EXPECT_THAT(ServeTurns(3), ElementsAre("b", "b", "b"));
}

TEST_F(TurnsTest, ComingAndLeavingOverAndOverGainsNothing) {
  ids_ = {"a", "b"};
  double passing_ms = 0.0;
  double staying_ms = 0.0;
  for (int i = 0; i < 1000; ++i) {
    // A new contender appears whenever the previous one has had a turn.
    ids_[1] = "b" + std::to_string(i);
    busy_.clear();
    Busy("a", TurnClass::kInteractive, 10.0);
    Busy(ids_[1], TurnClass::kInteractive, 100.0);
    std::string served;
    while (served != ids_[1]) {
      served = Serve();
      (served == "a" ? staying_ms : passing_ms) += served == "a" ? 10.0 : 100.0;
    }
  }
  EXPECT_NEAR(staying_ms / (staying_ms + passing_ms), 0.5, 0.01);
}

TEST_F(TurnsTest, WhoComesLongAfterAnotherHasLeftOwesNothing) {
  ids_ = {"a", "b"};
  Busy("a", TurnClass::kInteractive);
  Busy("b", TurnClass::kInteractive, 100.0);
  ServeTurns(2);
  ids_ = {"a"};
  ServeTurns(20);
  ids_ = {"a", "c"};
  Busy("c", TurnClass::kInteractive);
  EXPECT_THAT(ServeTurns(3), ElementsAre("c", "a", "c"));
}

TEST_F(TurnsTest, OwnViewsTogetherTakeHalfOfTheTime) {
  ids_ = {"a", "a/1", "a/2", "a/3", "b"};
  Busy("a", TurnClass::kInteractive);
  for (const char* own : {"a/1", "a/2", "a/3"}) Busy(own, TurnClass::kInteractive, 20.0);
  EXPECT_NEAR(ShareOf("a", 1e4), 0.5, 0.01);
  EXPECT_NEAR(ShareOf("a/2", 1e4), 1.0 / 6.0, 0.01);
  busy_.erase("a");
  EXPECT_NEAR(ShareOf("a/2", 1e4), 1.0 / 3.0, 0.01) << "all that nobody else uses";
}

TEST_F(TurnsTest, TheRoundGoesOnWhereTheLastServedHasGone) {
  for (const char* id : {"a", "b", "c"}) Busy(id, TurnClass::kInteractive);
  EXPECT_THAT(ServeTurns(2), ElementsAre("a", "b"));
  ids_ = {"a", "c"};
  EXPECT_THAT(ServeTurns(2), ElementsAre("c", "a"));
}

TEST_F(TurnsTest, WhatPeopleWaitForComesFirst) {
  Busy("a", TurnClass::kBatch);
  Busy("b", TurnClass::kRefining);
  Busy("c", TurnClass::kInteractive);
  EXPECT_EQ(Serve(), "c");
  busy_.erase("c");
  EXPECT_EQ(Serve(), "b");
  busy_.erase("b");
  EXPECT_EQ(Serve(), "a");
}

TEST_F(TurnsTest, TheOthersGetATenthHoweverMuchThereIsToDo) {
  Busy("a", TurnClass::kBatch, 15.0);
  Busy("c", TurnClass::kInteractive, 33.0);
  EXPECT_NEAR(ShareOf("a", 1e4), 0.1, 0.01);
  Busy("b", TurnClass::kRefining, 100.0);
  EXPECT_NEAR(ShareOf("a", 1e5), 0.1, 0.01);
  EXPECT_NEAR(ShareOf("b", 1e5), 0.1, 0.02);
  busy_.erase("c");
  EXPECT_NEAR(ShareOf("a", 1e4), 0.1, 0.02);
}

TEST_F(TurnsTest, AClassWithoutWorkSavesNothingUp) {
  Busy("c", TurnClass::kInteractive, 33.0);
  ServeTurns(100);
  Busy("a", TurnClass::kBatch, 15.0);
  EXPECT_THAT(ServeTurns(2), ElementsAre("c", "c"));
}

}  // namespace
}  // namespace thunderhead::drawing
