// Tests of the rules among a session's participants: who gets control, who follows the session's
// view, and who may make marks.
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

// A session with a presenter and two viewers, Ana and Ben.
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
  EXPECT_EQ(group.roster.MaySteer(group.ana).message(),
            "Teacher is in control; ask for control first");
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
  const absl::Status denied = group.roster.RefuseControl(group.ben, group.ana);
  EXPECT_EQ(ReasonOf(denied), "NOT_STEERING");
  EXPECT_EQ(denied.message(),
            "only a presenter or the person in control can give or refuse control");
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
  EXPECT_TRUE(group.roster.Find(back)->asks) << "until somebody answers";
  EXPECT_EQ(ReasonOf(group.roster.AskControl(back, kOpenedAt + seconds(2))), "ASKED_TOO_OFTEN");
  const std::uint64_t other = group.roster.Join(Role::kViewer, "", kOpenedAt + seconds(1), "other");
  EXPECT_TRUE(group.roster.AskControl(other, kOpenedAt + seconds(2)).ok());
  EXPECT_TRUE(group.roster.AskControl(back, kOpenedAt + kTimeouts.ask_again).ok());
}

TEST(RosterTest, ARequestComesBackWithItsRole) {
  Class group;
  const std::uint64_t eve = group.roster.Join(Role::kViewer, "Eve", kOpenedAt, "key");
  ASSERT_TRUE(group.roster.AskControl(eve, kOpenedAt).ok());
  group.roster.Leave(eve, kOpenedAt);
  const std::uint64_t presenting = group.roster.Join(Role::kPresenter, "Eve", kOpenedAt, "key");
  EXPECT_FALSE(group.roster.Find(presenting)->asks);
  const std::uint64_t back = group.roster.Join(Role::kViewer, "Eve", kOpenedAt, "key");
  EXPECT_TRUE(group.roster.Find(back)->asks);
}

TEST(RosterTest, WhoAskedAndComesBackHasControlThatIsFreeByNow) {
  for (const Rules& rules : {Rules{}, Rules{.viewers_may_steer = false}}) {
    Class group(rules);
    const std::uint64_t eve = group.roster.Join(Role::kViewer, "Eve", kOpenedAt, "key");
    ASSERT_TRUE(group.roster.AskControl(eve, kOpenedAt).ok());
    group.roster.Leave(eve, kOpenedAt);
    ASSERT_TRUE(group.roster.GiveControl(group.presenter, 0, kOpenedAt).ok());
    const std::uint64_t back = group.roster.Join(Role::kViewer, "Eve", kOpenedAt, "key");
    EXPECT_EQ(group.roster.steering(), rules.viewers_may_steer ? back : 0U);
    EXPECT_EQ(group.roster.Find(back)->asks, !rules.viewers_may_steer);
  }
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
  // A presenter who comes back does not get control merely by returning.
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

// A session with two presenters and the viewer Ana. All three have participant keys, and the first
// presenter has control.
struct ClassWithKeys {
  ClassWithKeys() : roster({.free_when_away = true}, kOpenedAt) {
    presenter = roster.Join(Role::kPresenter, "Teacher", kOpenedAt, "teacher");
    tablet = roster.Join(Role::kPresenter, "Tablet", kOpenedAt, "tablet");
    ana = roster.Join(Role::kViewer, "Ana", kOpenedAt, "ana");
  }

  std::uint64_t AnaAgain(Roster::Time now) { return roster.Join(Role::kViewer, "Ana", now, "ana"); }

  Roster roster;
  std::uint64_t presenter = 0;
  std::uint64_t tablet = 0;
  std::uint64_t ana = 0;
};

TEST(RosterTest, APresenterWhoReloadsSteersAgainThoughAnotherIsThere) {
  ClassWithKeys group;
  group.roster.Leave(group.presenter, kOpenedAt);
  EXPECT_EQ(group.roster.steering(), 0U);
  EXPECT_FALSE(group.roster.presenter_away()) << "the tablet's is there";
  const Roster::Time soon = kOpenedAt + kTimeouts.come_back - seconds(1);
  group.roster.Advance(soon);
  const std::uint64_t third = group.roster.Join(Role::kPresenter, "Colleague", soon, "colleague");
  EXPECT_EQ(group.roster.steering(), 0U) << "it waits for the one who steered";
  const std::uint64_t back = group.roster.Join(Role::kPresenter, "Teacher", soon, "teacher");
  EXPECT_EQ(group.roster.steering(), back);
  EXPECT_FALSE(group.roster.presenter_away());
  group.roster.Advance(kOpenedAt + std::chrono::hours(1));
  EXPECT_EQ(group.roster.steering(), back);
  EXPECT_NE(third, back);
}

TEST(RosterTest, ControlOfAPresenterWhoStaysAwayGoesToAnother) {
  ClassWithKeys group;
  group.roster.Leave(group.presenter, kOpenedAt);
  EXPECT_EQ(group.roster.NextDeadline(), kOpenedAt + kTimeouts.come_back);
  const std::uint64_t before = group.roster.revision();
  group.roster.Advance(kOpenedAt + kTimeouts.come_back);
  EXPECT_EQ(group.roster.steering(), group.tablet);
  EXPECT_GT(group.roster.revision(), before);
  // A presenter who comes back later gets control only by taking it with the button.
  group.roster.Join(Role::kPresenter, "Teacher", kOpenedAt + seconds(20), "teacher");
  EXPECT_EQ(group.roster.steering(), group.tablet);
}

TEST(RosterTest, APresenterNeedNotWaitForOneWhoHasLostTheConnection) {
  ClassWithKeys group;
  group.roster.Leave(group.presenter, kOpenedAt);
  ASSERT_TRUE(group.roster.TakeControl(group.tablet).ok());
  EXPECT_EQ(group.roster.steering(), group.tablet);
  group.roster.Join(Role::kPresenter, "Teacher", kOpenedAt + seconds(1), "teacher");
  EXPECT_EQ(group.roster.steering(), group.tablet);
}

TEST(RosterTest, AViewerWhoSteersAndReconnectsSteersAgain) {
  ClassWithKeys group;
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  EXPECT_EQ(group.roster.awaited(), nullptr);
  group.roster.Leave(group.ana, kOpenedAt);
  EXPECT_EQ(group.roster.steering(), 0U);
  EXPECT_FALSE(group.roster.control_is_free());
  ASSERT_NE(group.roster.awaited(), nullptr);
  EXPECT_EQ(group.roster.awaited()->name, "Ana");
  const std::uint64_t ben = group.roster.Join(Role::kViewer, "Ben", kOpenedAt, "ben");
  ASSERT_TRUE(group.roster.AskControl(ben, kOpenedAt).ok());
  EXPECT_EQ(group.roster.steering(), 0U);
  // A participant key is valid only for the role with which it was first used.
  group.roster.Join(Role::kPresenter, "Ana", kOpenedAt, "ana");
  EXPECT_EQ(group.roster.steering(), 0U);
  const std::uint64_t back = group.AnaAgain(kOpenedAt + seconds(5));
  EXPECT_EQ(group.roster.steering(), back);
  EXPECT_EQ(group.roster.awaited(), nullptr);
  group.roster.Leave(back, kOpenedAt + seconds(6));
  group.roster.Advance(kOpenedAt + seconds(6) + kTimeouts.come_back);
  EXPECT_EQ(group.roster.steering(), group.presenter) << "the first who is there";
  EXPECT_EQ(group.roster.awaited(), nullptr) << "not any more";
}

TEST(RosterTest, ControlOfAViewerWhoStaysAwayIsKeptForAPresenterWhoIsAwayToo) {
  Roster roster({.free_when_away = true}, kOpenedAt);
  roster.RestoreControl({.is_free = true}, kOpenedAt);
  const std::uint64_t ana = roster.Join(Role::kViewer, "Ana", kOpenedAt, "ana");
  ASSERT_TRUE(roster.AskControl(ana, kOpenedAt).ok());
  roster.Leave(ana, kOpenedAt);
  roster.Advance(kOpenedAt + kTimeouts.come_back);
  EXPECT_TRUE(roster.presenter_away());
  EXPECT_EQ(roster.NextDeadline(), kOpenedAt + kTimeouts.away);
  roster.Advance(kOpenedAt + kTimeouts.away);
  EXPECT_TRUE(roster.control_is_free());
}

TEST(RosterTest, OtherTimeoutsCountForWaitsThatHaveBegun) {
  ClassWithKeys group;
  group.roster.Leave(group.presenter, kOpenedAt);
  group.roster.SetTimeouts({.come_back = std::chrono::hours(2)});
  group.roster.Advance(kOpenedAt + std::chrono::hours(1));
  EXPECT_EQ(group.roster.steering(), 0U);
  EXPECT_EQ(group.roster.NextDeadline(), kOpenedAt + std::chrono::hours(2));
  group.roster.SetTimeouts({.come_back = seconds(0)});
  group.roster.Advance(kOpenedAt + std::chrono::hours(1));
  EXPECT_EQ(group.roster.steering(), group.tablet);
}

TEST(RosterTest, OnANewServerControlWaitsForTheViewerWhoSteered) {
  ClassWithKeys group;
  EXPECT_EQ(group.roster.ControlToKeep(), KeptControl()) << "a presenter's is any presenter's";
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  const KeptControl kept = group.roster.ControlToKeep();
  EXPECT_EQ(kept, (KeptControl{.viewer_key = "ana", .viewer_name = "Ana", .viewer_id = group.ana}));
  group.roster.Leave(group.ana, kOpenedAt);
  EXPECT_EQ(group.roster.ControlToKeep(), kept) << "while it waits for her";

  Roster roster({}, kOpenedAt);
  roster.RestoreControl(kept, kOpenedAt);
  ASSERT_NE(roster.awaited(), nullptr);
  EXPECT_EQ(roster.awaited()->name, "Ana");
  EXPECT_FALSE(roster.presenter_away());
  EXPECT_EQ(roster.ControlToKeep(), kept) << "if the server ends once more";
  const std::uint64_t teacher = roster.Join(Role::kPresenter, "Teacher", kOpenedAt, "teacher");
  EXPECT_GT(teacher, kept.viewer_id) << "else the one awaited would be the teacher";
  EXPECT_EQ(roster.steering(), 0U);
  const Roster::Time late = kOpenedAt + kTimeouts.come_back_to_new_server;
  EXPECT_EQ(roster.NextDeadline(), late);
  Roster waited = roster;
  const std::uint64_t ana = roster.Join(Role::kViewer, "Ana", late - seconds(1), "ana");
  EXPECT_EQ(roster.steering(), ana);
  waited.Advance(late);
  EXPECT_EQ(waited.steering(), teacher);
  EXPECT_EQ(waited.awaited(), nullptr);
}

// This happens after a change of network: the server has not yet noticed that the first connection
// is lost.
TEST(RosterTest, WhoComesBackReplacesALostConnectionThatGivesNoSignOfLife) {
  ClassWithKeys group;
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  const std::uint64_t back = group.AnaAgain(kOpenedAt);
  EXPECT_EQ(group.roster.Find(group.ana)->doubts, 1U);
  EXPECT_EQ(group.roster.Find(group.tablet)->doubts, 0U);
  group.roster.Checked(group.ana, 1, kOpenedAt);
  EXPECT_EQ(group.roster.NextDeadline(), kOpenedAt + kTimeouts.sign_of_life);
  EXPECT_TRUE(
      group.roster.Advance(kOpenedAt + kTimeouts.sign_of_life - std::chrono::milliseconds(1))
          .empty());
  EXPECT_EQ(group.roster.steering(), group.ana);
  EXPECT_THAT(group.roster.Advance(kOpenedAt + kTimeouts.sign_of_life),
              ::testing::ElementsAre(group.ana));
  EXPECT_EQ(group.roster.Find(group.ana), nullptr);
  EXPECT_EQ(group.roster.steering(), back);
}

// The answer to the connection check may be delayed, for example behind a large picture on a slow
// link.
TEST(RosterTest, TheTimeForASignOfLifeCountsFromTheQuestion) {
  ClassWithKeys group;
  group.AnaAgain(kOpenedAt);
  EXPECT_EQ(group.roster.NextDeadline(), kOpenedAt + kTimeouts.sign_of_life_in_all);
  group.roster.Checked(group.ana, 1, kOpenedAt + seconds(8));
  EXPECT_EQ(group.roster.NextDeadline(), kOpenedAt + seconds(8) + kTimeouts.sign_of_life);
  group.AnaAgain(kOpenedAt + seconds(9));
  group.roster.Checked(group.ana, 1, kOpenedAt + seconds(9));
  EXPECT_EQ(group.roster.NextDeadline(), kOpenedAt + seconds(9) + kTimeouts.sign_of_life_in_all)
      << "the second question is still on its way";
  group.roster.Heard(group.ana);
  group.roster.Advance(kOpenedAt + std::chrono::hours(1));
  EXPECT_NE(group.roster.Find(group.ana), nullptr);
}

TEST(RosterTest, WhoComesBackHasTheRequestOfTheLostConnection) {
  ClassWithKeys group;
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  const std::uint64_t back = group.AnaAgain(kOpenedAt + seconds(1));
  EXPECT_FALSE(group.roster.Find(back)->asks);
  group.roster.Checked(group.ana, 1, kOpenedAt + seconds(1));
  group.roster.Advance(kOpenedAt + seconds(1) + kTimeouts.sign_of_life);
  EXPECT_TRUE(group.roster.Find(back)->asks);
  EXPECT_EQ(group.roster.Find(back)->asked_at, kOpenedAt);
}

TEST(RosterTest, ARequestThatWasRefusedByLockingDoesNotComeBack) {
  ClassWithKeys group;
  ASSERT_TRUE(group.roster.AskControl(group.ana, kOpenedAt).ok());
  group.roster.Leave(group.ana, kOpenedAt);
  ASSERT_TRUE(group.roster.SetRules(group.presenter, {.control_locked = true}).ok());
  ASSERT_TRUE(group.roster.SetRules(group.presenter, {}).ok());
  EXPECT_FALSE(group.roster.Find(group.AnaAgain(kOpenedAt + seconds(1)))->asks);
}

// A duplicated tab brings the key of the original tab, whose connection is intact.
TEST(RosterTest, WhoGivesASignOfLifeStaysAndSteersOn) {
  ClassWithKeys group;
  ASSERT_TRUE(group.roster.GiveControl(group.presenter, group.ana, kOpenedAt).ok());
  const std::uint64_t duplicate = group.AnaAgain(kOpenedAt);
  group.roster.Heard(group.ana);
  EXPECT_EQ(group.roster.NextDeadline(), std::nullopt);
  EXPECT_TRUE(group.roster.Advance(kOpenedAt + std::chrono::hours(1)).empty());
  EXPECT_EQ(group.roster.steering(), group.ana);
  EXPECT_NE(group.roster.Find(duplicate), nullptr);
  EXPECT_EQ(group.roster.Find(duplicate)->doubts, 0U);
  group.roster.Leave(group.ana, kOpenedAt + std::chrono::hours(1));
  EXPECT_EQ(group.roster.steering(), duplicate) << "it is the same person";
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
