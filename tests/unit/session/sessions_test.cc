// Tests of a server's sessions: their keys, their limits, their end, and the order of revisions.
#include "session/sessions.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"

namespace thunderhead::session {
namespace {

using std::chrono::minutes;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class SessionsTest : public ::testing::Test {
 protected:
  std::shared_ptr<Session> Create(const std::string& owner = "") {
    auto created = sessions_.Create({}, owner);
    EXPECT_TRUE(created.ok()) << created.status();
    return *std::move(created);
  }

  testing::ManualTime time_;
  int works_ = 0;
  Sessions sessions_{
      {.max_sessions = 3, .max_sessions_per_owner = 2, .idle_timeout = minutes(15), .time = &time_},
      {.on_work = [this] { ++works_; }, .on_due = [] {}}};
};

TEST_F(SessionsTest, EachKeyOpensTheSessionWithItsRole) {
  const auto session = Create();
  const auto presenter = sessions_.Find(session->keys().presenter);
  const auto viewer = sessions_.Find(session->keys().viewer);
  ASSERT_TRUE(presenter.ok() && viewer.ok());
  EXPECT_EQ(presenter->session, session);
  EXPECT_EQ(presenter->role, Role::kPresenter);
  EXPECT_EQ(viewer->session, session);
  EXPECT_EQ(viewer->role, Role::kViewer);
  EXPECT_TRUE(absl::IsNotFound(sessions_.Find(session->id()).status())) << "an id is no key";
}

TEST_F(SessionsTest, OnlyThePresentersKeyCloses) {
  const auto session = Create();
  EXPECT_TRUE(absl::IsPermissionDenied(sessions_.Close(session->keys().viewer)));
  EXPECT_FALSE(session->HasEnded());
  EXPECT_TRUE(sessions_.Close(session->keys().presenter).ok());
  EXPECT_TRUE(session->HasEnded());
  EXPECT_TRUE(absl::IsNotFound(sessions_.Find(session->keys().viewer).status()));
}

TEST_F(SessionsTest, TooManySessionsAreRefusedUntilOneEnds) {
  const auto first = Create("ana");
  Create("ana");
  EXPECT_TRUE(absl::IsResourceExhausted(sessions_.Create({}, "ana").status()));
  Create("ben");
  EXPECT_TRUE(absl::IsResourceExhausted(sessions_.Create({}, "cleo").status()));
  EXPECT_TRUE(sessions_.Close(first->keys().presenter).ok());
  Create("cleo");
}

TEST_F(SessionsTest, AnIdleSessionExpiresAndAUsedOneDoesNot) {
  const auto used = Create();
  const auto idle = Create();
  time_.Advance(minutes(10));
  EXPECT_TRUE(sessions_.Find(used->keys().viewer).ok());
  time_.Advance(minutes(10));
  EXPECT_THAT(sessions_.All(), ElementsAre(used));
  EXPECT_TRUE(idle->HasEnded());
}

TEST_F(SessionsTest, AfterTheEndNothingIsFoundOrCreated) {
  const auto session = Create();
  sessions_.CloseAll(absl::UnavailableError("the server stops"));
  EXPECT_TRUE(absl::IsUnavailable(sessions_.Find(session->keys().viewer).status()));
  EXPECT_TRUE(absl::IsUnavailable(sessions_.Create().status()));
  EXPECT_FALSE(session->HasEnded()) << "a stored session ends only if it was closed or expires";
}

TEST_F(SessionsTest, TheUpdateThatArrivedLastWins) {
  const auto session = Create();
  const std::uint64_t first = session->TakeRevision();
  const std::uint64_t second = session->TakeRevision();
  EXPECT_TRUE(session->Show(second, {}, "second"));
  EXPECT_TRUE(session->Show(first, {}, "first"));
  EXPECT_EQ(*session->Newest()->serialized, "second");
  EXPECT_EQ(works_, 1) << "a scene that came too late is not drawn";
}

TEST_F(SessionsTest, AnUpdateOfAnOlderRevisionIsAborted) {
  const auto session = Create();
  const std::uint64_t first = session->TakeRevision();
  session->Show(first, {}, "first");
  const auto second = session->TakeRevisionAfter(first, {.serialized = "second"});
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(session->NewestTaken()->scene, "second");
  EXPECT_TRUE(absl::IsAborted(session->TakeRevisionAfter(first).status()));
  // After the pending update was dropped, the first one is the newest again.
  session->Drop(*second);
  EXPECT_EQ(session->NewestTaken()->scene, "first");
  EXPECT_TRUE(session->TakeRevisionAfter(first).ok());
}

TEST_F(SessionsTest, AnUpdateWhoseSenderLostControlIsNotShown) {
  const auto session = Create();
  bool in_control = true;
  const std::uint64_t first = session->TakeRevision();
  session->Show(first, {}, "first");
  const auto update = session->TakeRevisionAfter(
      first, {.still_counts = [&in_control] { return in_control; }, .serialized = "overruled"});
  in_control = false;
  ASSERT_TRUE(session->TakeRevisionAfter(first).ok());
  EXPECT_FALSE(session->Show(*update, {}, "overruled"));
  EXPECT_EQ(*session->Newest()->serialized, "first");
}

TEST_F(SessionsTest, ARestoredSessionHasItsKeysAndLargerRevisions) {
  const auto session = Create("ana");
  const std::uint64_t revision = session->TakeRevision();
  session->Show(revision, {}, "scene");
  const SessionRecord record = session->Record();
  Sessions others({.time = &time_}, {.on_work = [] {}, .on_due = [] {}});
  const auto restored = others.Restore(record, {}, record.scene);
  EXPECT_EQ(restored->keys(), session->keys());
  EXPECT_EQ(restored->owner(), "ana");
  EXPECT_GT(restored->Newest()->revision, revision);
  EXPECT_TRUE(others.Find(record.keys.viewer).ok());
}

TEST_F(SessionsTest, AnOwnViewFollowsTheSceneFromItsCameraWhileItIsHeld) {
  const auto session = Create();
  scene::Scene scene;
  scene.storm_id = "moore";
  session->Show(session->TakeRevision(), scene);
  const scene::OrbitCamera camera{.azimuth_deg = 77.0};
  auto view = sessions_.OpenView(session, camera, "ana");
  EXPECT_THAT(sessions_.AllDrawn(), ElementsAre(session, view->drawn()));
  scene.storm_id = "joplin";
  session->Show(session->TakeRevision(), scene);
  const auto seen = view->drawn()->Newest()->scene;
  EXPECT_EQ(seen->storm_id, "joplin");
  EXPECT_EQ(seen->camera, scene::Camera(camera));
  view.reset();
  EXPECT_THAT(sessions_.AllDrawn(), ElementsAre(session));
}

TEST_F(SessionsTest, RefusedSessionsLeaveTheOthers) {
  const auto session = Create();
  sessions_.RefuseNew(absl::UnavailableError("the server stops soon"));
  EXPECT_TRUE(absl::IsUnavailable(sessions_.Create().status()));
  EXPECT_TRUE(sessions_.Find(session->keys().viewer).ok());
}

}  // namespace
}  // namespace thunderhead::session
