// The rules of control, following and marks among a session's people.
#include "session/roster.h"

#include "base/error_details.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::session {
namespace {

using std::chrono::seconds;

const Roster::Time kOpenedAt = Roster::Time() + std::chrono::hours(1);
const RosterTimeouts kTimeouts;

std::string ReasonOf(const absl::Status& status) { return base::DetailsOf(status).reason; }

// A presenter, Ana and Ben.
struct Class {
  explicit Class(const Rules& rules = {}) : roster(rules, kOpenedAt) {
    presenter = roster.Join(Role::kPresenter, "Teacher", kOpenedAt);
    ana = roster.Join(Role::kViewer, "Ana", kOpenedAt);
    ben = roster.Join(Role::kViewer, "", kOpenedAt);
  }

  Roster roster;
  std::uint64_t presenter = 0;
  std::uint64_t ana = 0;
  std::uint64_t ben = 0;
};

absl::StatusOr<bool> Detach(Class& group, std::uint64_t id) {
  return group.roster.Detach(id, group.roster.Find(id)->returns);
}

TEST(RosterTest, PresenterSteersOnComing) {
  const Class group;
  EXPECT_EQ(group.roster.steering(), group.presenter);
  EXPECT_TRUE(group.roster.MaySteer(group.presenter).ok());
  EXPECT_EQ(ReasonOf(group.roster.MaySteer(group.ana)), "NOT_STEERING");
  EXPECT_EQ(group.roster.MaySteer(group.ana).message(), "Teacher steers; ask for control first");
}

TEST(RosterTest, NobodySteersWithTheIdOfNobody) {
  Class group;
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, 0, kOpenedAt).ok());
  EXPECT_FALSE(group.roster.MaySteer(0).ok());
}

TEST(RosterTest, ViewersWaitForAPresenterWhoIsOnTheWay) {
  Roster roster({}, kOpenedAt);
  const std::uint64_t ana = roster.Join(Role::kViewer, "Ana", kOpenedAt);
  ASSERT_TRUE(roster.AskControl(ana, kOpenedAt).ok());
  EXPECT_EQ(roster.steering(), 0U);
  EXPECT_TRUE(roster.presenter_away());
  const std::uint64_t presenter = roster.Join(Role::kPresenter, "", kOpenedAt);
  EXPECT_EQ(roster.steering(), presenter);
  EXPECT_FALSE(roster.presenter_away());
}

TEST(RosterTest, WhoSteersIsAskedAndGives) {
  Class group;
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  EXPECT_TRUE(group.roster.Find(group.ana)->asks);
  EXPECT_EQ(group.roster.steering(), group.presenter);
  EXPECT_EQ(ReasonOf(group.roster.GiveControl(group.ben, group.ana, kOpenedAt)), "NOT_STEERING");
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  EXPECT_EQ(group.roster.steering(), group.ana);
  EXPECT_FALSE(group.roster.Find(group.ana)->asks);
  EXPECT_FALSE(group.roster.MaySteer(group.presenter).ok());
}

TEST(RosterTest, ARequestEndsUnanswered) {
  Class group;
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  group.roster.Advance(kOpenedAt + kTimeouts.answer - seconds(1));
  EXPECT_TRUE(group.roster.Find(group.ana)->asks);
  const std::uint64_t before = group.roster.revision();
  group.roster.Advance(kOpenedAt + kTimeouts.answer);
  EXPECT_FALSE(group.roster.Find(group.ana)->asks);
  EXPECT_GT(group.roster.revision(), before);
}

TEST(RosterTest, ARefusedRequestEnds) {
  Class group;
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  ASSERT_TRUE(group.roster.RefuseControl(group.presenter, group.ana).ok());
  EXPECT_FALSE(group.roster.Find(group.ana)->asks);
  EXPECT_EQ(group.roster.steering(), group.presenter);
}

TEST(RosterTest, AskingIsRateLimited) {
  Class group;
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  const absl::Status again = group.roster.AskControl(group.ana, kOpenedAt + seconds(1));
  EXPECT_TRUE(absl::IsResourceExhausted(again));
  EXPECT_EQ(base::DetailsOf(again).retry_after, std::chrono::milliseconds(4000));
  EXPECT_TRUE(group.roster.AskControl(group.ben, kOpenedAt + seconds(1)).ok()) << "another person";
  EXPECT_TRUE(group.roster.AskControl(group.ana, kOpenedAt + kTimeouts.ask_again).ok());
}

TEST(RosterTest, FreeControlGoesToWhoAsksFirst) {
  Class group;
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, 0, kOpenedAt).ok());
  ASSERT_EQ(group.roster.steering(), 0U);
  ASSERT_TRUE(group.roster.AskControl(group.ben, kOpenedAt).ok());
  EXPECT_EQ(group.roster.steering(), group.ben);
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  EXPECT_EQ(group.roster.steering(), group.ben);
}

TEST(RosterTest, ControlThatBecomesFreeGoesToWhoHasAskedLongest) {
  Class group;
  ASSERT_TRUE(group.roster.AskControl(group.ben, kOpenedAt).ok());
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt + seconds(1)).ok());
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, 0, kOpenedAt + seconds(2)).ok());
  EXPECT_EQ(group.roster.steering(), group.ben);
  EXPECT_FALSE(group.roster.Find(group.ben)->asks);
  EXPECT_TRUE(group.roster.Find(group.ana)->asks);
}

TEST(RosterTest, ControlThatIsFreeBecauseThePresentersAreAwayGoesToWhoAsks) {
  Class group({.free_when_away = true});
  group.roster.Leave(group.presenter, kOpenedAt);
  const Roster::Time asked_at = kOpenedAt + kTimeouts.away - seconds(1);
  ASSERT_TRUE(group.roster.AskControl(group.ana, asked_at).ok());
  group.roster.Advance(kOpenedAt + kTimeouts.away);
  EXPECT_EQ(group.roster.steering(), group.ana);
}

TEST(RosterTest, WhoComesBackHasAskedBefore) {
  Class group;
  const std::uint64_t eve = group.roster.Join(Role::kViewer, "Eve", kOpenedAt, "key");
  ASSERT_TRUE(group.roster.AskControl(eve, kOpenedAt).ok());
  group.roster.Leave(eve, kOpenedAt + seconds(1));
  const std::uint64_t back = group.roster.Join(Role::kViewer, "Eve", kOpenedAt + seconds(1), "key");
  EXPECT_EQ(ReasonOf(group.roster.AskControl(back, kOpenedAt + seconds(2))), "ASKED_TOO_OFTEN");
  const std::uint64_t other = group.roster.Join(Role::kViewer, "", kOpenedAt + seconds(1), "other");
  EXPECT_TRUE(group.roster.AskControl(other, kOpenedAt + seconds(2)).ok());
  EXPECT_TRUE(group.roster.AskControl(back, kOpenedAt + kTimeouts.ask_again).ok());
}

TEST(RosterTest, FreeControlIsNotGivenWhereViewersMayNotSteer) {
  Class group({.viewers_may_steer = false});
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, 0, kOpenedAt).ok());
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  EXPECT_EQ(group.roster.steering(), 0U);
  EXPECT_TRUE(group.roster.Find(group.ana)->asks) << "for a presenter to answer";
}

TEST(RosterTest, LockedControlIsRefusedAndEndsRequests) {
  Class group;
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  ASSERT_TRUE(group.roster.SetRules(group.presenter, {.control_locked = true}).ok());
  EXPECT_FALSE(group.roster.Find(group.ana)->asks);
  EXPECT_EQ(ReasonOf(group.roster.AskControl(group.ben, kOpenedAt)), "CONTROL_LOCKED");
}

TEST(RosterTest, AViewerDoesNotPassOnLockedControl) {
  Class group;
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  ASSERT_TRUE(group.roster.SetRules(group.presenter, {.control_locked = true}).ok());
  EXPECT_EQ(ReasonOf(group.roster.GiveControl(group.ana, group.ben, kOpenedAt)), "CONTROL_LOCKED");
  EXPECT_EQ(group.roster.steering(), group.ana);
  ASSERT_TRUE(group.roster.GiveControl(group.ana, group.presenter, kOpenedAt).ok());
  EXPECT_EQ(group.roster.steering(), group.presenter);
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok())
      << "a presenter may";
  ASSERT_TRUE(group.roster.GiveControl(group.ana, 0, kOpenedAt).ok());
  EXPECT_EQ(group.roster.steering(), group.presenter);
}

TEST(RosterTest, PresenterTakesControlBackAlways) {
  Class group({.control_locked = true});
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  EXPECT_EQ(ReasonOf(group.roster.TakeControl(group.ben)), "NOT_PRESENTER");
  EXPECT_EQ(group.roster.steering(), group.ana);
  ASSERT_TRUE(group.roster.TakeControl(group.presenter).ok());
  EXPECT_EQ(group.roster.steering(), group.presenter);
}

TEST(RosterTest, ViewersControlGoesBackToThePresenter) {
  Class group;
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  ASSERT_TRUE(group.roster.GiveControl(group.ana, 0, kOpenedAt).ok());
  EXPECT_EQ(group.roster.steering(), group.presenter);
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ben, kOpenedAt).ok());
  group.roster.Leave(group.ben, kOpenedAt);
  EXPECT_EQ(group.roster.steering(), group.presenter);
}

TEST(RosterTest, ControlIsKeptForAPresenterWhoReloads) {
  Class group({.free_when_away = true});
  group.roster.Leave(group.presenter, kOpenedAt);
  EXPECT_TRUE(group.roster.presenter_away());
  group.roster.Advance(kOpenedAt + seconds(59));
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt + seconds(59)).ok());
  EXPECT_EQ(group.roster.steering(), 0U);
  const std::uint64_t back = group.roster.Join(Role::kPresenter, "Teacher", kOpenedAt);
  EXPECT_EQ(group.roster.steering(), back);
}

TEST(RosterTest, ControlOfAnAbsentPresenterBecomesFreeIfChosen) {
  Class group({.free_when_away = true});
  group.roster.Leave(group.presenter, kOpenedAt);
  group.roster.Advance(kOpenedAt + kTimeouts.away);
  EXPECT_FALSE(group.roster.presenter_away());
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt + kTimeouts.away).ok());
  EXPECT_EQ(group.roster.steering(), group.ana);
  // A presenter who comes back does not take it by coming.
  const std::uint64_t back = group.roster.Join(Role::kPresenter, "Teacher", kOpenedAt);
  EXPECT_EQ(group.roster.steering(), group.ana);
  EXPECT_TRUE(group.roster.TakeControl(back).ok());
}

TEST(RosterTest, ControlOfAnAbsentPresenterStaysElse) {
  Class group;
  group.roster.Leave(group.presenter, kOpenedAt);
  group.roster.Advance(kOpenedAt + std::chrono::hours(1));
  EXPECT_TRUE(group.roster.presenter_away());
}

TEST(RosterTest, SecondPresenterTakesOverFromOneWhoLeaves) {
  Class group;
  const std::uint64_t second = group.roster.Join(Role::kPresenter, "Tablet", kOpenedAt);
  EXPECT_EQ(group.roster.steering(), group.presenter);
  group.roster.Leave(group.presenter, kOpenedAt);
  EXPECT_EQ(group.roster.steering(), second);
}

TEST(RosterTest, LockedFollowingEndsLookingAround) {
  Class group;
  ASSERT_TRUE(Detach(group, group.ana).ok());
  ASSERT_TRUE(Detach(group, group.presenter).ok());
  ASSERT_TRUE(group.roster.SetRules(group.presenter, {.following_locked = true}).ok());
  EXPECT_TRUE(group.roster.Find(group.ana)->follows);
  EXPECT_FALSE(group.roster.Find(group.presenter)->follows) << "a presenter may";
  EXPECT_EQ(ReasonOf(Detach(group, group.ana).status()), "FOLLOWING_LOCKED");
}

TEST(RosterTest, ReturningToTheSessionsViewCountsBeforeAnEarlierRequestToLeaveIt) {
  Class group;
  const auto leaves = [&](std::uint64_t returns) {
    return *group.roster.Detach(group.ana, returns) && !group.roster.Find(group.ana)->follows;
  };
  const std::uint64_t before = group.roster.Find(group.ana)->returns;
  ASSERT_TRUE(group.roster.Follow(group.ana).ok());
  EXPECT_FALSE(leaves(before));
  EXPECT_TRUE(group.roster.Find(group.ana)->follows);
  const std::uint64_t followed = group.roster.Find(group.ana)->returns;
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  EXPECT_FALSE(leaves(followed)) << "who steers sees what is steered";
  EXPECT_TRUE(leaves(group.roster.Find(group.ana)->returns));
}

TEST(RosterTest, WhoGetsControlFollows) {
  Class group;
  ASSERT_TRUE(Detach(group, group.ana).ok());
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  EXPECT_TRUE(group.roster.Find(group.ana)->follows);
}

TEST(RosterTest, ViewersMarkOnlyIfAllowed) {
  Class group;
  EXPECT_TRUE(group.roster.MayMark(group.presenter).ok());
  EXPECT_EQ(ReasonOf(group.roster.MayMark(group.ana)), "MARKS_LOCKED");
  ASSERT_TRUE(group.roster.SetRules(group.presenter, {.viewers_may_mark = true}).ok());
  EXPECT_TRUE(group.roster.MayMark(group.ana).ok());
  EXPECT_EQ(ReasonOf(group.roster.SetRules(group.ana, {})), "NOT_PRESENTER");
}

TEST(RosterTest, PresenterWithTheKeyAloneDoesNotInterruptAViewer) {
  Class group;
  EXPECT_TRUE(group.roster.PresenterMaySteer().ok());
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  EXPECT_EQ(ReasonOf(group.roster.PresenterMaySteer()), "NOT_STEERING");
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, 0, kOpenedAt).ok());
  EXPECT_TRUE(group.roster.PresenterMaySteer().ok());
}

TEST(RosterTest, EveryChangeHasARevision) {
  Class group;
  const std::uint64_t first = group.roster.revision();
  group.roster.SetHidden(group.ana, true);
  const std::uint64_t second = group.roster.revision();
  EXPECT_GT(second, first);
  group.roster.SetHidden(group.ana, true);
  EXPECT_EQ(group.roster.revision(), second) << "nothing changed";
  EXPECT_TRUE(absl::IsNotFound(group.roster.Follow(99)));
  EXPECT_EQ(group.roster.revision(), second);
}

}  // namespace
}  // namespace thunderhead::session
