// Tests of Interact, the one call that serves a whole session. The server enforces each rule.
#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "access/access_control.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "telemetry/metrics.h"
#include "tests/service/fake_service.h"
#include "tests/service/interacting.h"
#include "tests/support/running_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

using ::testing::HasSubstr;
using Response = v1::InteractResponse;
using Stub = v1::ThunderheadService::Stub;

v1::CreateSessionResponse Create(FakeService& service, const v1::SessionRules& rules = {}) {
  v1::CreateSessionRequest request;
  *request.mutable_scene() = SmallScene();
  *request.mutable_rules() = rules;
  v1::CreateSessionResponse response;
  const grpc::Status status = Call(service.stub(), &Stub::CreateSession, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response;
}

v1::InteractRequest SunTo(float azimuth_deg) {
  v1::InteractRequest request;
  v1::SceneUpdate& update = *request.mutable_update_scene();
  *update.mutable_scene() = SmallScene();
  update.mutable_scene()->mutable_sun()->set_azimuth_deg(azimuth_deg);
  return request;
}

// A scene whose update is slow, because the storm must be read to place its camera.
v1::InteractRequest SlowSunTo(float azimuth_deg) {
  v1::InteractRequest request = SunTo(azimuth_deg);
  v1::Scene& scene = *request.mutable_update_scene()->mutable_scene();
  scene.set_time_index(2);
  scene.mutable_camera()->mutable_spotter();
  return request;
}

v1::InteractRequest Asks() {
  v1::InteractRequest request;
  request.mutable_ask_control();
  return request;
}

v1::InteractRequest Gives(std::uint64_t viewer_id) {
  v1::InteractRequest request;
  request.mutable_give_control()->set_viewer_id(viewer_id);
  return request;
}

v1::InteractRequest Takes() {
  v1::InteractRequest request;
  request.mutable_take_control();
  return request;
}

v1::InteractRequest LooksFrom(float azimuth_deg) {
  v1::InteractRequest request;
  request.mutable_detach()->mutable_camera()->mutable_orbit()->set_azimuth_deg(azimuth_deg);
  return request;
}

v1::InteractRequest Follows() {
  v1::InteractRequest request;
  request.mutable_follow();
  return request;
}

v1::InteractRequest Locks(bool following) {
  v1::InteractRequest request;
  request.mutable_set_rules()->mutable_rules()->set_following_locked(following);
  return request;
}

// Returns a ray straight down through the middle of the fake storm's cloud.
v1::Ray RayDown() {
  v1::Ray ray;
  ray.mutable_origin()->set_x_m(-5500.0F);
  ray.mutable_origin()->set_y_m(-500.0F);
  ray.mutable_origin()->set_z_m(20000.0F);
  ray.mutable_direction()->set_z(-1.0F);
  return ray;
}

v1::InteractRequest Draws() {
  v1::InteractRequest request;
  *request.mutable_add_mark()->add_rays() = RayDown();
  return request;
}

const v1::Person* Find(const v1::Presence& presence, std::uint64_t viewer_id) {
  const auto at = std::ranges::find(presence.people(), viewer_id, &v1::Person::viewer_id);
  return at == presence.people().end() ? nullptr : &*at;
}

v1::InteractRequest Refuses(std::uint64_t viewer_id) {
  v1::InteractRequest request;
  request.mutable_refuse_control()->set_viewer_id(viewer_id);
  return request;
}

v1::InteractRequest LocksControl(bool locked) {
  v1::InteractRequest request;
  request.mutable_set_rules()->mutable_rules()->set_control_locked(locked);
  return request;
}

v1::InteractRequest Erases() {
  v1::InteractRequest request;
  request.mutable_erase_marks();
  return request;
}

v1::SessionRules ViewersMayMark() {
  v1::SessionRules rules;
  rules.set_viewers_may_mark(true);
  return rules;
}

using Timeouts = session::RosterTimeouts;

// The value of the timeouts (of requests for control, absence and the like) that a test examines.
// They do not expire before the test advances the time.
constexpr std::chrono::milliseconds kTimeout = std::chrono::hours(1);

service::ServerOptions With(const std::vector<std::chrono::milliseconds Timeouts::*>& timeouts,
                            const base::TimeSource& time) {
  service::ServerOptions options = Patient(time);
  for (const auto timeout : timeouts) options.sessions.roster_timeouts.*timeout = kTimeout;
  return options;
}

// A session with its presenter and two viewers, Ana and Ben.
struct Class {
  explicit Class(const v1::SessionRules& rules = {},
                 const service::ServerOptions& options = Patient())
      : service(options), created(Create(service, rules)) {
    presenter =
        std::make_unique<Interacting>(service.stub(), created.session_id(), Named("Teacher"));
    EXPECT_GT(presenter->viewer_id(), 0U);
    ana = std::make_unique<Interacting>(service.stub(), created.viewer_key(), Named("Ana"));
    EXPECT_GT(ana->viewer_id(), 0U);
    ben = std::make_unique<Interacting>(service.stub(), created.viewer_key(), Named("Ben"));
    EXPECT_GT(ben->viewer_id(), 0U);
    EXPECT_TRUE(SteersFor(*ben, presenter->viewer_id()));
  }

  static Interacting::Options Named(const std::string& name) { return {.name = name}; }

  static bool SteersFor(Interacting& person, std::uint64_t viewer_id) {
    return person.AwaitPresence([&](const v1::Presence& presence) {
      return presence.people_size() >= 3 && presence.steering_viewer_id() == viewer_id;
    });
  }

  // Advances the time, and waits until the server has ended everything that has expired. To detect
  // this, Ben first asks for control; his request expires after kTimeout.
  bool RosterSees(RunningTime& time, std::chrono::milliseconds moved) {
    ben->Send(Asks());
    if (!AsksFor(*ana, ben->viewer_id(), true)) return false;
    time.Advance(moved);
    return AsksFor(*ana, ben->viewer_id(), false);
  }

  static bool AsksFor(Interacting& person, std::uint64_t viewer_id, bool asks) {
    return person.AwaitPresence([&](const v1::Presence& presence) {
      const v1::Person* const one = Find(presence, viewer_id);
      return one != nullptr && one->asks_control() == asks;
    });
  }

  FakeService service;
  v1::CreateSessionResponse created;
  std::unique_ptr<Interacting> presenter;
  std::unique_ptr<Interacting> ana;
  std::unique_ptr<Interacting> ben;
};

TEST(InteractTest, KeysDifferAndTellTheRole) {
  FakeService service;
  const auto created = Create(service);
  EXPECT_THAT(created.viewer_key(), ::testing::MatchesRegex("[0-9a-f]{32}"));
  EXPECT_NE(created.viewer_key(), created.session_id());
  Interacting presenter(service.stub(), created.session_id());
  Interacting viewer(service.stub(), created.viewer_key());
  const auto joined = presenter.AwaitNewest(Response::kJoined).joined();
  EXPECT_EQ(joined.role(), v1::ROLE_PRESENTER);
  EXPECT_EQ(joined.viewer_key(), created.viewer_key());
  EXPECT_EQ(viewer.AwaitNewest(Response::kJoined).joined().role(), v1::ROLE_VIEWER);
}

TEST(InteractTest, AJoinerIsToldEverythingAtOnce) {
  Class group;
  ASSERT_TRUE(group.ben->AwaitFrame(1));
  const Interacting::Messages messages = group.ben->All();
  EXPECT_TRUE(messages.front().has_joined());
  EXPECT_EQ(group.ben->AwaitNewest(Response::kScene).scene().scene().storm_id(), "anvil");
  ASSERT_TRUE(group.ben->AwaitPresence(
      [](const v1::Presence& presence) { return presence.people_size() == 3; }));
  const v1::Presence presence = group.ben->AwaitNewest(Response::kPresence).presence();
  EXPECT_EQ(presence.people(0).name(), "Teacher");
  EXPECT_EQ(presence.people(0).role(), v1::ROLE_PRESENTER);
  EXPECT_EQ(presence.people(1).name(), "Ana");
  EXPECT_TRUE(presence.rules().has_viewers_may_steer());
}

// Presence messages are sent at most once in 0.2 s. A viewer who joins must not get a presence
// message from before the join.
TEST(InteractTest, TheFirstPresenceOfAJoinerHasTheJoiner) {
  Class group;
  std::vector<std::unique_ptr<Interacting>> people;
  for (int i = 0; i < 2; ++i) {
    people.push_back(std::make_unique<Interacting>(group.service.stub(), group.created.viewer_key(),
                                                   Class::Named("")));
    ASSERT_GT(people.back()->viewer_id(), 0U);
  }
  for (const auto& person : people) {
    person->AwaitNewest(Response::kPresence);
    const auto messages = person->All();
    const auto first = std::ranges::find(messages, Response::kPresence, &Response::message_case);
    EXPECT_NE(Find(first->presence(), person->viewer_id()), nullptr);
  }
}

TEST(InteractTest, FramesAreThoseOfWatchFrames) {
  Class group;
  Watcher watcher(group.service.stub(), group.created.viewer_key());
  ASSERT_TRUE(watcher.AwaitFrame(1, true));
  const v1::Frame watched = watcher.NewestFrame();
  ASSERT_TRUE(group.ana->Await([&](const Interacting::Messages& messages) {
    return std::ranges::any_of(messages, [&](const Response& message) {
      return message.frame().sequence() == watched.sequence();
    });
  }));
  for (const Response& message : group.ana->All()) {
    if (message.frame().sequence() != watched.sequence()) continue;
    EXPECT_EQ(message.frame().SerializeAsString(), watched.SerializeAsString());
  }
  EXPECT_TRUE(watched.has_view());
}

// The fake frame source draws only 8 bits a channel, so no AVIF image follows when the scene rests.
// JPEG then replaces video.
TEST(InteractTest, VideoComesToWhoDecodesItOnly) {
  RunningTime time;
  Class group({}, Patient(time));
  Interacting video(group.service.stub(), group.created.viewer_key(),
                    {.codecs = {v1::CODEC_VP9, v1::CODEC_AVIF}, .saves_bytes = true});
  Interacting jpeg(group.service.stub(), group.created.viewer_key(), {.saves_bytes = true});
  Watcher old(group.service.stub(), group.created.session_id());
  ASSERT_TRUE(video.AwaitFrame(1));
  ASSERT_TRUE(jpeg.AwaitFrame(1));
  // The clock is stopped, so that no scene counts as resting and no link as slow.
  time.Stop();
  std::uint64_t revision = 1;
  for (int i = 0; i < 20; ++i) {
    const std::uint64_t request = group.presenter->Send(SunTo(100.0F + static_cast<float>(i)));
    revision = group.presenter->Answer(request).scene_taken().scene_revision();
    ASSERT_TRUE(video.AwaitFrame(revision));
    ASSERT_TRUE(jpeg.AwaitFrame(revision));
  }
  time.Advance(std::chrono::seconds(10));
  ASSERT_TRUE(old.AwaitFrame(revision, true));
  EXPECT_FALSE(old.NewestFrame().jpeg().empty());
  EXPECT_TRUE(old.NewestFrame().vp9().empty());
  for (const Response& message : jpeg.All()) {
    EXPECT_TRUE(message.frame().vp9().empty());
    EXPECT_EQ(message.has_frame(), !message.frame().jpeg().empty());
  }
  int pictures = 0;
  for (const Response& message : video.All()) {
    if (message.frame().vp9().empty()) continue;
    EXPECT_TRUE(message.frame().jpeg().empty());
    EXPECT_EQ(pictures == 0, message.frame().key_frame()) << "picture " << pictures;
    ++pictures;
  }
  EXPECT_GE(pictures, 10);
}

TEST(InteractTest, ThePresentersUpdateReachesEverybody) {
  Class group;
  const std::uint64_t request = group.presenter->Send(SunTo(120.0F));
  const Response answer = group.presenter->Answer(request);
  ASSERT_TRUE(answer.has_scene_taken()) << answer.ShortDebugString();
  const std::uint64_t revision = answer.scene_taken().scene_revision();
  EXPECT_EQ(revision, 2U);
  for (Interacting* const person : {group.presenter.get(), group.ana.get(), group.ben.get()}) {
    EXPECT_TRUE(person->AwaitFrame(revision));
    EXPECT_EQ(person->AwaitScene(revision).sun().azimuth_deg(), 120.0F);
  }
}

TEST(InteractTest, AViewerDoesNotSteerUnlessGivenControl) {
  Class group;
  EXPECT_EQ(group.ana->AnswerCode(group.ana->Send(SunTo(120.0F))),
            grpc::StatusCode::PERMISSION_DENIED);
  group.ana->Send(Asks());
  ASSERT_TRUE(group.presenter->AwaitPresence([&](const v1::Presence& presence) {
    const v1::Person* const ana = Find(presence, group.ana->viewer_id());
    return ana != nullptr && ana->asks_control();
  }));
  EXPECT_EQ(group.ben->AnswerCode(group.ben->Send(Gives(group.ben->viewer_id()))),
            grpc::StatusCode::PERMISSION_DENIED);
  group.presenter->Send(Gives(group.ana->viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ana, group.ana->viewer_id()));
  EXPECT_EQ(group.ana->AnswerCode(group.ana->Send(SunTo(120.0F))), grpc::StatusCode::OK);
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send(SunTo(130.0F))),
            grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(group.ben->AnswerCode(group.ben->Send(Takes())), grpc::StatusCode::PERMISSION_DENIED);
  group.presenter->Send(Takes());
  ASSERT_TRUE(Class::SteersFor(*group.ana, group.presenter->viewer_id()));
  EXPECT_EQ(group.ana->AnswerCode(group.ana->Send(SunTo(140.0F))),
            grpc::StatusCode::PERMISSION_DENIED);
}

TEST(InteractTest, LockedControlIsNotAskedFor) {
  Class group;
  group.ana->Send(Asks());
  ASSERT_TRUE(Class::AsksFor(*group.presenter, group.ana->viewer_id(), true));
  group.presenter->Send(LocksControl(true));
  ASSERT_TRUE(group.ben->AwaitPresence(
      [](const v1::Presence& presence) { return presence.rules().control_locked(); }));
  EXPECT_TRUE(Class::AsksFor(*group.ben, group.ana->viewer_id(), false)) << "it was locked since";
  const v1::Refused refused = group.ben->Answer(group.ben->Send(Asks())).refused();
  EXPECT_EQ(refused.status().code(), static_cast<int>(grpc::StatusCode::PERMISSION_DENIED));
  EXPECT_EQ(ReasonOf(refused.status()), "CONTROL_LOCKED");
  group.presenter->Send(LocksControl(false));
  ASSERT_TRUE(group.ben->AwaitPresence(
      [](const v1::Presence& presence) { return !presence.rules().control_locked(); }));
  group.ben->Send(Asks());
  EXPECT_TRUE(Class::AsksFor(*group.presenter, group.ben->viewer_id(), true));
}

TEST(InteractTest, WhoAsksTooOftenIsToldWhenToAskAgain) {
  RunningTime time;
  Class group({}, With({&Timeouts::ask_again}, time));
  group.ana->Send(Asks());
  const v1::Refused refused = group.ana->Answer(group.ana->Send(Asks())).refused();
  EXPECT_EQ(refused.status().code(), static_cast<int>(grpc::StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_EQ(ReasonOf(refused.status()), "ASKED_TOO_OFTEN");
  const std::chrono::milliseconds wait = RetryAfterOf(refused.status());
  EXPECT_GT(wait, std::chrono::milliseconds(0));
  EXPECT_LE(wait, kTimeout);
  // Meanwhile another viewer may ask for control.
  group.ben->Send(Asks());
  EXPECT_TRUE(Class::AsksFor(*group.presenter, group.ben->viewer_id(), true));
  group.presenter->Send(Refuses(group.ana->viewer_id()));
  ASSERT_TRUE(Class::AsksFor(*group.presenter, group.ana->viewer_id(), false));
  time.Advance(wait);
  group.ana->Send(Asks());
  EXPECT_TRUE(Class::AsksFor(*group.presenter, group.ana->viewer_id(), true));
}

TEST(InteractTest, ARefusedRequestEndsAndControlStays) {
  Class group;
  group.ana->Send(Asks());
  ASSERT_TRUE(Class::AsksFor(*group.presenter, group.ana->viewer_id(), true));
  const v1::Refused refused =
      group.ben->Answer(group.ben->Send(Refuses(group.ana->viewer_id()))).refused();
  EXPECT_EQ(refused.status().code(), static_cast<int>(grpc::StatusCode::PERMISSION_DENIED));
  EXPECT_EQ(ReasonOf(refused.status()), "NOT_STEERING");
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send(Refuses(99))),
            grpc::StatusCode::NOT_FOUND);
  EXPECT_TRUE(Class::AsksFor(*group.ana, group.ana->viewer_id(), true)) << "not yet answered";
  group.presenter->Send(Refuses(group.ana->viewer_id()));
  EXPECT_TRUE(Class::AsksFor(*group.ana, group.ana->viewer_id(), false));
  EXPECT_TRUE(Class::SteersFor(*group.ana, group.presenter->viewer_id()));
}

TEST(InteractTest, ARequestThatNobodyAnswersEnds) {
  RunningTime time;
  Class group({}, With({&Timeouts::answer}, time));
  group.ana->Send(Asks());
  ASSERT_TRUE(Class::AsksFor(*group.presenter, group.ana->viewer_id(), true));
  // No viewer does anything meanwhile.
  time.Advance(kTimeout);
  EXPECT_TRUE(Class::AsksFor(*group.presenter, group.ana->viewer_id(), false));
  EXPECT_TRUE(Class::AsksFor(*group.ana, group.ana->viewer_id(), false));
  EXPECT_TRUE(Class::SteersFor(*group.ana, group.presenter->viewer_id()));
}

TEST(InteractTest, FreeControlGoesToWhoAsksFirst) {
  Class group;
  group.presenter->Send(Gives(0));
  ASSERT_TRUE(Class::SteersFor(*group.ben, 0));
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send(SunTo(110.0F))),
            grpc::StatusCode::PERMISSION_DENIED)
      << "nobody steers";
  group.ben->Send(Asks());
  ASSERT_TRUE(Class::SteersFor(*group.ana, group.ben->viewer_id()));
  EXPECT_EQ(group.ben->AnswerCode(group.ben->Send(SunTo(120.0F))), grpc::StatusCode::OK);
  // The next request has to wait for Ben's answer.
  group.ana->Send(Asks());
  ASSERT_TRUE(Class::AsksFor(*group.ben, group.ana->viewer_id(), true));
  EXPECT_TRUE(Class::SteersFor(*group.ben, group.ben->viewer_id()));
  group.ben->Send(Gives(group.ana->viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ben, group.ana->viewer_id()));
  // If a viewer gives control to no particular person (id 0), control returns to the presenter.
  group.ana->Send(Gives(0));
  EXPECT_TRUE(Class::SteersFor(*group.ana, group.presenter->viewer_id()));
}

TEST(InteractTest, FreeControlIsAskedForWhereViewersMayNotSteer) {
  v1::SessionRules rules;
  rules.set_viewers_may_steer(false);
  Class group(rules);
  group.presenter->Send(Gives(0));
  ASSERT_TRUE(Class::SteersFor(*group.ana, 0));
  group.ana->Send(Asks());
  ASSERT_TRUE(Class::AsksFor(*group.presenter, group.ana->viewer_id(), true));
  EXPECT_TRUE(Class::SteersFor(*group.presenter, 0));
  group.presenter->Send(Gives(group.ana->viewer_id()));
  EXPECT_TRUE(Class::SteersFor(*group.ben, group.ana->viewer_id()));
}

TEST(InteractTest, ControlOfAnAbsentPresenterBecomesFreeIfChosen) {
  RunningTime time;
  v1::SessionRules rules;
  rules.set_free_when_away(true);
  Class group(rules, With({&Timeouts::away, &Timeouts::come_back}, time));
  group.presenter->Cancel();
  ASSERT_TRUE(group.ana->AwaitPresence(
      [](const v1::Presence& presence) { return presence.presenter_away(); }));
  // No viewer does anything meanwhile.
  time.Advance(kTimeout);
  ASSERT_TRUE(group.ana->AwaitPresence([](const v1::Presence& presence) {
    return !presence.presenter_away() && presence.steering_viewer_id() == 0;
  }));
  group.ana->Send(Asks());
  const auto ana_steers = [&](const v1::Presence& presence) {
    return presence.steering_viewer_id() == group.ana->viewer_id();
  };
  ASSERT_TRUE(group.ben->AwaitPresence(ana_steers));
  // A presenter who comes back can take control, but does not get it merely by returning.
  Interacting back(group.service.stub(), group.created.session_id(), {.name = "Teacher"});
  ASSERT_TRUE(group.ben->AwaitPresence([&](const v1::Presence& presence) {
    return presence.people_size() == 3 && ana_steers(presence);
  }));
  back.Send(Takes());
  EXPECT_TRUE(Class::SteersFor(*group.ben, back.viewer_id()));
}

TEST(InteractTest, ControlOfAnAbsentPresenterStaysElse) {
  RunningTime time;
  Class group({}, With({&Timeouts::away, &Timeouts::come_back, &Timeouts::answer}, time));
  group.presenter->Cancel();
  ASSERT_TRUE(group.ana->AwaitPresence(
      [](const v1::Presence& presence) { return presence.presenter_away(); }));
  ASSERT_TRUE(group.RosterSees(time, 5 * kTimeout));
  group.ana->Send(Asks());
  ASSERT_TRUE(Class::AsksFor(*group.ben, group.ana->viewer_id(), true)) << "it waits";
  EXPECT_TRUE(group.ben->AwaitPresence([](const v1::Presence& presence) {
    return presence.presenter_away() && presence.steering_viewer_id() == 0;
  }));
}

TEST(InteractTest, ASecondPresenterTakesOverFromOneWhoStaysAway) {
  RunningTime time;
  Class group({}, With({&Timeouts::come_back}, time));
  Interacting tablet(group.service.stub(), group.created.session_id(), {.name = "Tablet"});
  ASSERT_GT(tablet.viewer_id(), 0U);
  EXPECT_EQ(tablet.AnswerCode(tablet.Send(SunTo(120.0F))), grpc::StatusCode::PERMISSION_DENIED);
  group.presenter->Leave();
  ASSERT_TRUE(Class::SteersFor(*group.ana, 0));
  time.Advance(kTimeout);
  ASSERT_TRUE(Class::SteersFor(*group.ana, tablet.viewer_id()));
  EXPECT_EQ(tablet.AnswerCode(tablet.Send(SunTo(120.0F))), grpc::StatusCode::OK);
}

TEST(InteractTest, EverybodyIsToldWhichTimesAreInMemory) {
  RunningTime time;
  Class group({}, Patient(time));
  const auto told = [&](Interacting& person, const std::vector<std::uint32_t>& times) {
    time.Advance(std::chrono::seconds(1));  // the server checks its memory once a second
    return person.Await([&](const Interacting::Messages& messages) {
      return std::ranges::any_of(messages, [&](const Response& message) {
        return message.has_times_in_memory() && message.times_in_memory().storm_id() == "anvil" &&
               std::ranges::equal(message.times_in_memory().time_indices(), times);
      });
    });
  };
  const std::uint32_t shown = group.ben->AwaitScene(1).time_index();
  EXPECT_TRUE(told(*group.ben, {shown}));
  // Reads another time of the storm into memory, as read-ahead does. No scene shows this time.
  const std::uint32_t ahead = shown == 2 ? 1 : 2;
  ASSERT_TRUE(group.service.store->Get("anvil", static_cast<int>(ahead), {}).ok());
  const std::vector<std::uint32_t> both = {std::min(shown, ahead), std::max(shown, ahead)};
  EXPECT_TRUE(told(*group.presenter, both));
  EXPECT_TRUE(told(*group.ben, both));
  Interacting late(group.service.stub(), group.created.viewer_key());
  EXPECT_TRUE(told(late, both));
}

TEST(InteractTest, AMovingSceneIsToldSeldomAndInTheEndWhole) {
  RunningTime time;
  Class group({}, Patient(time));
  time.Stop();
  std::uint64_t revision = 0;
  for (int i = 0; i < 40; ++i) {
    const float azimuth_deg = 100.0F + static_cast<float>(i);
    revision = group.presenter->Answer(group.presenter->Send(SunTo(azimuth_deg)))
                   .scene_taken()
                   .scene_revision();
  }
  time.Advance(session::Audience::kScenePause);
  EXPECT_EQ(group.ana->AwaitScene(revision).sun().azimuth_deg(), 139.0F);
  const Interacting::Messages messages = group.ana->All();
  EXPECT_LT(std::ranges::count_if(messages, [](const auto& m) { return m.has_scene(); }), 5);
}

TEST(InteractTest, OfTwoWhoChangeTheSameRevisionOneIsTold) {
  Class group;
  v1::InteractRequest first = SunTo(120.0F);
  first.mutable_update_scene()->set_expected_revision(1);
  v1::InteractRequest second = SunTo(130.0F);
  second.mutable_update_scene()->set_expected_revision(1);
  const std::uint64_t first_id = group.presenter->Send(first);
  const std::uint64_t second_id = group.presenter->Send(second);
  EXPECT_EQ(group.presenter->AnswerCode(first_id), grpc::StatusCode::OK);
  const v1::Refused refused = group.presenter->Answer(second_id).refused();
  EXPECT_EQ(refused.status().code(), static_cast<int>(grpc::StatusCode::ABORTED));
  EXPECT_THAT(refused.status().message(), HasSubstr("the scene is at revision 2, not 1"));
  EXPECT_GT(refused.status().details_size(), 0);
  EXPECT_EQ(group.presenter->AwaitScene(2).sun().azimuth_deg(), 120.0F);
}

// Control may change hands while the server reads the storm on which an update's camera depends.
TEST(InteractTest, AnUpdateIsNotShownAfterControlWasTaken) {
  Class group;
  group.presenter->Send(Gives(group.ana->viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ben, group.ana->viewer_id()));
  group.service.store->reading.Close();
  const std::uint64_t waits = group.ana->Send(SlowSunTo(90.0F));
  ASSERT_TRUE(group.service.store->reading.AwaitWaiting(1));
  group.presenter->Send(Takes());
  ASSERT_TRUE(Class::SteersFor(*group.ben, group.presenter->viewer_id()));
  // Ana's pending update does not delay an update of the presenter, who now has control. This
  // update expects revision 1, which is still shown.
  v1::InteractRequest next = SunTo(120.0F);
  next.mutable_update_scene()->set_expected_revision(1);
  const Response taken = group.presenter->Answer(group.presenter->Send(next));
  ASSERT_TRUE(taken.has_scene_taken()) << taken.ShortDebugString();
  EXPECT_EQ(group.ben->AwaitScene(taken.scene_taken().scene_revision()).sun().azimuth_deg(),
            120.0F);
  group.service.store->reading.Open();
  const Response refused = group.ana->Answer(waits);
  EXPECT_EQ(refused.refused().status().code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(ReasonOf(refused.refused().status()), "NOT_STEERING");
  for (const Response& message : group.ben->All()) {
    EXPECT_NE(message.scene().scene().sun().azimuth_deg(), 90.0F);
  }
}

// An outdated update must not overwrite changes made meanwhile, even if its sender has regained
// control by then.
TEST(InteractTest, AnUpdateThatWasOverruledIsRefusedToWhoSteersAgain) {
  Class group;
  group.presenter->Send(Gives(group.ana->viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ben, group.ana->viewer_id()));
  group.service.store->reading.Close();
  const std::uint64_t waits = group.ana->Send(SlowSunTo(90.0F));
  ASSERT_TRUE(group.service.store->reading.AwaitWaiting(1));
  group.presenter->Send(Takes());
  ASSERT_TRUE(Class::SteersFor(*group.ben, group.presenter->viewer_id()));
  v1::InteractRequest next = SunTo(120.0F);
  next.mutable_update_scene()->set_expected_revision(1);
  ASSERT_TRUE(group.presenter->Answer(group.presenter->Send(next)).has_scene_taken());
  group.presenter->Send(Gives(group.ana->viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ben, group.ana->viewer_id()));
  group.service.store->reading.Open();
  const Response refused = group.ana->Answer(waits);
  EXPECT_EQ(refused.refused().status().code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(ReasonOf(refused.refused().status()), "REVISION_CHANGED");
}

// The second request leaves some fields alone. They keep the values of the first request, which is
// not shown yet.
TEST(InteractTest, AChangeOfSomeFieldsIsTakenWhileTheSceneBeforeItWaitsForItsStorm) {
  Class group;
  group.service.store->reading.Close();
  const std::uint64_t waits = group.presenter->Send(SlowSunTo(90.0F));
  ASSERT_TRUE(group.service.store->reading.AwaitWaiting(1));
  v1::InteractRequest exposes;
  exposes.mutable_update_scene()->mutable_scene()->mutable_display()->set_exposure_ev(0.5F);
  exposes.mutable_update_scene()->mutable_update_mask()->add_paths("display.exposure_ev");
  const std::uint64_t follows = group.presenter->Send(exposes);
  // The server reads requests in order, so when it has handled this one it has read the others.
  v1::InteractRequest rename;
  rename.mutable_set_name()->set_name("Read");
  group.presenter->Send(rename);
  ASSERT_TRUE(group.ben->AwaitPresence([](const v1::Presence& presence) {
    return std::ranges::any_of(presence.people(),
                               [](const v1::Person& person) { return person.name() == "Read"; });
  }));
  group.service.store->reading.Open();
  ASSERT_TRUE(group.presenter->Answer(waits).has_scene_taken());
  const Response taken = group.presenter->Answer(follows);
  ASSERT_TRUE(taken.has_scene_taken()) << taken.ShortDebugString();
  const v1::Scene scene = group.ben->AwaitScene(taken.scene_taken().scene_revision());
  EXPECT_EQ(scene.sun().azimuth_deg(), 90.0F);
  EXPECT_EQ(scene.time_index(), 2U);
  EXPECT_EQ(scene.display().exposure_ev(), 0.5F);
}

TEST(InteractTest, ARefusedSceneDoesNotBlockTheNextChange) {
  Class group;
  v1::InteractRequest wrong = SunTo(120.0F);
  wrong.mutable_update_scene()->set_expected_revision(1);
  wrong.mutable_update_scene()->mutable_scene()->set_storm_id("unknown");
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send(wrong)), grpc::StatusCode::NOT_FOUND);
  v1::InteractRequest right = SunTo(120.0F);
  right.mutable_update_scene()->set_expected_revision(1);
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send(right)), grpc::StatusCode::OK);
}

TEST(InteractTest, AMaskTakesTheNamedFieldsOnly) {
  Class group;
  v1::InteractRequest request = SunTo(120.0F);
  v1::SceneUpdate& update = *request.mutable_update_scene();
  update.mutable_scene()->mutable_display()->set_exposure_ev(3.0F);
  update.mutable_update_mask()->add_paths("display.exposure_ev");
  ASSERT_EQ(group.presenter->AnswerCode(group.presenter->Send(request)), grpc::StatusCode::OK);
  const v1::Scene scene = group.presenter->AwaitScene(2);
  EXPECT_EQ(scene.display().exposure_ev(), 3.0F);
  EXPECT_NE(scene.sun().azimuth_deg(), 120.0F);
  EXPECT_EQ(scene.output().width_px(), SmallScene().output().width_px());
  update.mutable_update_mask()->add_paths("camera.spotter.azimuth_deg");
  EXPECT_THAT(group.presenter->Answer(group.presenter->Send(request)).refused().status().message(),
              HasSubstr("the scene's kind is not spotter"));
  update.mutable_update_mask()->clear_paths();
  update.mutable_update_mask()->add_paths("colour");
  const v1::Refused refused = group.presenter->Answer(group.presenter->Send(request)).refused();
  EXPECT_THAT(refused.status().message(), HasSubstr("names 'colour'"));
}

TEST(InteractTest, LookingAroundAndComingBack) {
  Class group;
  ASSERT_TRUE(group.ana->AwaitFrame(1));
  group.ana->Send(LooksFrom(90.0F));
  ASSERT_TRUE(group.ana->AwaitFrame(1, /*own_view=*/true));
  const auto is_own = [](const Response& message) { return message.frame().own_view(); };
  for (const Response& message : group.ana->All()) {
    if (!is_own(message)) continue;
    EXPECT_EQ(message.frame().camera().orbit().azimuth_deg(), 90.0F);
  }
  v1::InteractRequest move;
  move.mutable_move_camera()->mutable_camera()->mutable_orbit()->set_azimuth_deg(45.0F);
  group.ana->Send(move);
  EXPECT_TRUE(group.ana->Await([](const Interacting::Messages& messages) {
    return std::ranges::any_of(messages, [](const Response& message) {
      return message.frame().own_view() && message.frame().camera().orbit().azimuth_deg() == 45.0F;
    });
  }));
  // Time and light remain those of the session.
  group.presenter->Send(SunTo(120.0F));
  EXPECT_TRUE(group.ana->Await([](const Interacting::Messages& messages) {
    return std::ranges::any_of(messages, [](const Response& message) {
      return message.frame().own_view() &&
             message.frame().camera().orbit().azimuth_deg() == 45.0F &&
             message.frame().sun().azimuth_deg() == 120.0F;
    });
  }));
  ASSERT_TRUE(group.ben->AwaitPresence([&](const v1::Presence& presence) {
    const v1::Person* const ana = Find(presence, group.ana->viewer_id());
    return ana != nullptr && !ana->follows();
  }));
  for (const Response& message : group.ben->All()) EXPECT_FALSE(is_own(message));
  group.ana->Send(Follows());
  EXPECT_TRUE(group.ana->AwaitFrame(2, /*own_view=*/false));
}

TEST(InteractTest, WhoIsRefusedAViewOfTheirOwnGoesOnFollowing) {
  Class group;
  ASSERT_TRUE(group.ana->AwaitFrame(1));
  ASSERT_TRUE(group.service.store->Remove("anvil").ok());
  v1::InteractRequest detach;
  detach.mutable_detach()->mutable_camera()->mutable_spotter();  // the server chooses the place
  EXPECT_EQ(group.ana->AnswerCode(group.ana->Send(detach)), grpc::StatusCode::NOT_FOUND);
  v1::InteractRequest move;
  move.mutable_move_camera()->mutable_camera()->mutable_orbit()->set_azimuth_deg(45.0F);
  const Response refused = group.ana->Answer(group.ana->Send(move));
  EXPECT_EQ(ReasonOf(refused.refused().status()), "NOT_DETACHED");
  v1::InteractRequest rename;
  rename.mutable_set_name()->set_name("Anna");
  group.ana->Send(rename);
  EXPECT_TRUE(group.ben->AwaitPresence([&](const v1::Presence& presence) {
    const v1::Person* const ana = Find(presence, group.ana->viewer_id());
    return ana != nullptr && ana->name() == "Anna" && ana->follows();
  }));
}

// A class whose session changes to another time, which is read until the gate opens. Ana has
// requested a view from a place that depends on the storm at that time.
struct SlowlyLeaving : Class {
  SlowlyLeaving() {
    EXPECT_TRUE(ana->AwaitFrame(1));
    service.store->reading.Close();
    v1::InteractRequest later;
    v1::SceneUpdate& update = *later.mutable_update_scene();
    update.mutable_scene()->set_time_index(2);
    update.mutable_update_mask()->add_paths("time_index");
    EXPECT_EQ(presenter->AnswerCode(presenter->Send(later)), grpc::StatusCode::OK);
    EXPECT_TRUE(service.store->reading.AwaitWaiting(1));
    v1::InteractRequest detach;
    detach.mutable_detach()->mutable_camera()->mutable_spotter();
    ana->Send(detach);
    EXPECT_TRUE(service.store->reading.AwaitWaiting(2));
  }
  ~SlowlyLeaving() { service.store->reading.Open(); }

  // Waits until all of Ana's requests are handled. Requests are handled in order, so it sends a
  // last one, which changes her name.
  bool AnaIsObeyed() {
    v1::InteractRequest rename;
    rename.mutable_set_name()->set_name("Anna");
    ana->Send(rename);
    return ben->AwaitPresence([&](const v1::Presence& presence) {
      const v1::Person* const person = Find(presence, ana->viewer_id());
      return person != nullptr && person->name() == "Anna";
    });
  }

  bool AnaFollows(bool follows) {
    return ben->AwaitPresence([&](const v1::Presence& presence) {
      const v1::Person* const person = Find(presence, ana->viewer_id());
      return person != nullptr && person->follows() == follows;
    });
  }
};

TEST(InteractTest, WhoComesBackBeforeTheOwnViewIsThereStays) {
  SlowlyLeaving group;
  group.ana->Send(Follows());
  ASSERT_TRUE(group.AnaIsObeyed());
  group.service.store->reading.Open();
  ASSERT_TRUE(group.ana->AwaitFrame(2, /*own_view=*/false));
  // Camera motions are accepted while the own view is pending, and refused once it is known that
  // the view cannot be made.
  v1::InteractRequest move;
  move.mutable_move_camera()->mutable_camera()->mutable_orbit()->set_azimuth_deg(45.0F);
  const auto is_refused = [](const Response& message) {
    return message.has_refused() && ReasonOf(message.refused().status()) == "NOT_DETACHED";
  };
  ASSERT_TRUE(WaitFor([&] {
    group.ana->Send(move);
    return std::ranges::any_of(group.ana->All(), is_refused);
  }));
  EXPECT_TRUE(group.AnaFollows(true));
}

TEST(InteractTest, TheOwnViewIsFromWhereItWasTurnedToWhileItCame) {
  SlowlyLeaving group;
  v1::InteractRequest move;
  move.mutable_move_camera()->mutable_camera()->mutable_orbit()->set_azimuth_deg(45.0F);
  group.ana->Send(move);
  ASSERT_TRUE(group.AnaIsObeyed());
  group.service.store->reading.Open();
  ASSERT_TRUE(group.AnaFollows(false));
  EXPECT_TRUE(group.ana->Await([](const Interacting::Messages& messages) {
    return std::ranges::any_of(messages, [](const Response& message) {
      return message.frame().own_view() && message.frame().camera().orbit().azimuth_deg() == 45.0F;
    });
  }));
}

TEST(InteractTest, NobodyPointsWithoutTheRightOrJoinsTwice) {
  Class group;
  v1::InteractRequest point;
  *point.mutable_point()->mutable_ray() = RayDown();
  EXPECT_EQ(group.ana->AnswerCode(group.ana->Send(point)), grpc::StatusCode::PERMISSION_DENIED);
  v1::InteractRequest join;
  join.mutable_join()->set_session_key(group.created.session_id());
  const Response refused = group.ana->Answer(group.ana->Send(join));
  EXPECT_EQ(ReasonOf(refused.refused().status()), "ALREADY_JOINED");
}

TEST(InteractTest, LockedFollowingBringsEverybodyBack) {
  Class group;
  group.ana->Send(LooksFrom(90.0F));
  ASSERT_TRUE(group.ana->AwaitFrame(1, /*own_view=*/true));
  group.presenter->Send(Locks(true));
  ASSERT_TRUE(group.ana->AwaitPresence([&](const v1::Presence& presence) {
    return presence.rules().following_locked() && Find(presence, group.ana->viewer_id())->follows();
  }));
  group.presenter->Send(SunTo(120.0F));
  EXPECT_TRUE(group.ana->AwaitFrame(2, /*own_view=*/false));
  EXPECT_EQ(group.ana->AnswerCode(group.ana->Send(LooksFrom(10.0F))),
            grpc::StatusCode::PERMISSION_DENIED);
}

TEST(InteractTest, AViewerSetsNoRules) {
  Class group;
  EXPECT_EQ(group.ana->AnswerCode(group.ana->Send(Locks(true))),
            grpc::StatusCode::PERMISSION_DENIED);
}

TEST(InteractTest, PointersAndMarksLieWhereTheyMeetTheStorm) {
  Class group;
  v1::InteractRequest point;
  *point.mutable_point()->mutable_ray() = RayDown();
  group.presenter->Send(point);
  const Response pointers = group.ana->AwaitNewest(Response::kPointers);
  ASSERT_EQ(pointers.pointers().pointers_size(), 1);
  const v1::Pointer& pointer = pointers.pointers().pointers(0);
  EXPECT_EQ(pointer.viewer_id(), group.presenter->viewer_id());
  EXPECT_EQ(pointer.position().x_m(), -5500.0F);
  // The cloud is in the third cell, whose middle is 1250 m high. Its smooth edge ends at the middle
  // of the next cell, and the ray meets it from above.
  EXPECT_GT(pointer.position().z_m(), 1250.0F);
  EXPECT_LE(pointer.position().z_m(), 1750.0F);
  group.presenter->Send(Draws());
  ASSERT_TRUE(group.ana->Await([](const Interacting::Messages& messages) {
    return std::ranges::any_of(
        messages, [](const Response& message) { return message.marks().marks_size() == 1; });
  }));
  const v1::Mark mark = group.ana->AwaitNewest(Response::kMarks).marks().marks(0);
  EXPECT_EQ(mark.positions(0).z_m(), pointer.position().z_m());
  v1::InteractRequest gone;
  gone.mutable_point();
  group.presenter->Send(gone);
  EXPECT_TRUE(group.ana->Await([](const Interacting::Messages& messages) {
    const auto newest = std::find_if(messages.rbegin(), messages.rend(),
                                     [](const auto& message) { return message.has_pointers(); });
    return newest->pointers().pointers_size() == 0;
  }));
}

TEST(InteractTest, ALineHasOneDepth) {
  Class group;
  v1::InteractRequest request;
  v1::AddMark& mark = *request.mutable_add_mark();
  // Two corners lie on the cloud. The third ray misses it and meets the ground, 1250 m lower.
  *mark.add_rays() = RayDown();
  *mark.add_rays() = RayDown();
  v1::Ray& beside = *mark.add_rays();
  beside = RayDown();
  beside.mutable_origin()->set_x_m(5500.0F);
  group.presenter->Send(request);
  ASSERT_TRUE(group.ana->Await([](const Interacting::Messages& messages) {
    return std::ranges::any_of(
        messages, [](const Response& message) { return message.marks().marks_size() == 1; });
  }));
  const v1::Mark drawn = group.ana->AwaitNewest(Response::kMarks).marks().marks(0);
  ASSERT_EQ(drawn.positions_size(), 3);
  EXPECT_GT(drawn.positions(2).z_m(), 900.0F);
  EXPECT_EQ(drawn.positions(2).z_m(), drawn.positions(0).z_m());
  EXPECT_EQ(drawn.positions(2).x_m(), 5500.0F);
}

TEST(InteractTest, ViewersMarkIfAllowedAndEraseTheirOwn) {
  Class group;
  EXPECT_EQ(group.ana->AnswerCode(group.ana->Send(Draws())), grpc::StatusCode::PERMISSION_DENIED);
  group.presenter->Send(Draws());
  v1::InteractRequest allow;
  allow.mutable_set_rules()->mutable_rules()->set_viewers_may_mark(true);
  group.presenter->Send(allow);
  ASSERT_TRUE(group.ana->AwaitPresence(
      [](const v1::Presence& presence) { return presence.rules().viewers_may_mark(); }));
  const auto marks_are = [&](int count) {
    return group.ben->Await([&](const Interacting::Messages& messages) {
      const auto newest = std::find_if(messages.rbegin(), messages.rend(),
                                       [](const auto& message) { return message.has_marks(); });
      return newest != messages.rend() && newest->marks().marks_size() == count;
    });
  };
  group.ana->Send(Draws());
  ASSERT_TRUE(marks_are(2));
  v1::InteractRequest erase_others;
  const v1::Marks both = group.ben->AwaitNewest(Response::kMarks).marks();
  for (const v1::Mark& mark : both.marks()) {
    erase_others.mutable_erase_marks()->add_mark_ids(mark.mark_id());
  }
  const Response refused = group.ana->Answer(group.ana->Send(erase_others));
  EXPECT_EQ(ReasonOf(refused.refused().status()), "NOT_YOUR_MARK");
  ASSERT_TRUE(marks_are(2));
  v1::InteractRequest erase;
  erase.mutable_erase_marks();
  group.ana->Send(erase);
  ASSERT_TRUE(marks_are(1));
  EXPECT_EQ(group.ben->AwaitNewest(Response::kMarks).marks().marks(0).viewer_id(),
            group.presenter->viewer_id());
  group.presenter->Send(erase);
  EXPECT_TRUE(marks_are(0));
}

TEST(InteractTest, MarksAreSeenOverTheStormsOfTheDomainThatTheyWereDrawnOn) {
  Class group;
  group.service.store->Become("clear", [](storm_store::StormInfo& storm) {
    storm.file_cells = {30, 10, 5};
  });
  const auto has = [](Interacting& person, int count) {
    return person.AwaitMarks([&](const v1::Marks& marks) { return marks.marks_size() == count; });
  };
  const auto show = [&](const std::string& storm_id) {
    v1::InteractRequest request = SunTo(120.0F);
    request.mutable_update_scene()->mutable_scene()->set_storm_id(storm_id);
    return group.presenter->Answer(group.presenter->Send(request)).has_scene_taken();
  };
  group.presenter->Send(Draws());
  ASSERT_TRUE(has(*group.ana, 1));
  ASSERT_TRUE(show("clear"));
  EXPECT_TRUE(has(*group.ana, 0));
  Interacting late(group.service.stub(), group.created.viewer_key());
  EXPECT_TRUE(has(late, 0));
  ASSERT_TRUE(show("anvil"));
  EXPECT_TRUE(has(*group.ana, 1));
  EXPECT_TRUE(has(late, 1));
  // Replaces the storm by another run over the same domain.
  group.service.store->Become("clear", [](storm_store::StormInfo& storm) {
    storm.file_cells = {20, 10, 7};
  });
  ASSERT_TRUE(show("clear"));
  group.presenter->Send(Draws());
  EXPECT_TRUE(has(*group.ana, 2));
}

TEST(InteractTest, OnlyChangesOfMarksAreToldAndAllOfThemToNewcomers) {
  Class group;
  const auto has = [](Interacting& person, int count) {
    return person.AwaitMarks([&](const v1::Marks& marks) { return marks.marks_size() == count; });
  };
  for (int drawn = 1; drawn <= 4; ++drawn) {
    group.presenter->Send(Draws());
    ASSERT_TRUE(has(*group.ana, drawn));
  }
  const v1::Marks all = group.ana->AwaitNewest(Response::kMarks).marks();
  v1::InteractRequest erase;
  erase.mutable_erase_marks()->add_mark_ids(all.marks(1).mark_id());
  group.presenter->Send(erase);
  ASSERT_TRUE(has(*group.ana, 3));
  const std::vector<v1::Marks> told = group.ana->MarksAsTold();
  ASSERT_EQ(told.size(), 5U);
  for (int drawn = 2; drawn <= 4; ++drawn) {
    const v1::Marks& change = told[static_cast<std::size_t>(drawn - 1)];
    EXPECT_TRUE(change.only_changes());
    ASSERT_EQ(change.marks_size(), 1);
    EXPECT_EQ(change.marks(0).mark_id(), all.marks(drawn - 1).mark_id());
  }
  EXPECT_EQ(told[4].marks_size(), 0);
  EXPECT_THAT(told[4].erased_mark_ids(), ::testing::ElementsAre(all.marks(1).mark_id()));
  Interacting newcomer(group.service.stub(), group.created.viewer_key());
  ASSERT_TRUE(has(newcomer, 3));
  EXPECT_FALSE(newcomer.MarksAsTold().front().only_changes());
}

TEST(InteractTest, AClientThatKnowsNoChangesIsToldAllMarksEachTime) {
  Class group;
  Interacting old(group.service.stub(), group.created.viewer_key(), {.is_old = true});
  for (int drawn = 1; drawn <= 3; ++drawn) {
    group.presenter->Send(Draws());
    ASSERT_TRUE(old.AwaitMarks([&](const v1::Marks& all) { return all.marks_size() == drawn; }));
  }
  for (const v1::Marks& told : old.MarksAsTold()) EXPECT_FALSE(told.only_changes());
}

TEST(InteractTest, WhoComesBackHasTheOwnMarksAgain) {
  Class group(ViewersMayMark());
  EXPECT_THAT(group.ana->participant_key(), ::testing::MatchesRegex("[0-9a-f]{32}"));
  EXPECT_NE(group.ana->participant_key(), group.ben->participant_key());
  group.presenter->Send(Draws());
  group.ana->Send(Draws());
  const auto drawn_by = [](const v1::Marks& marks, std::uint64_t viewer_id) {
    return std::ranges::count(marks.marks(), viewer_id, &v1::Mark::viewer_id);
  };
  ASSERT_TRUE(group.ben->AwaitMarks([&](const v1::Marks& marks) {
    return marks.marks_size() == 2 && drawn_by(marks, group.ana->viewer_id()) == 1;
  }));
  // The server still counts the connection that Ana lost as hers, as it may do for a while.
  Interacting back(group.service.stub(), group.created.viewer_key(),
                   {.name = "Ana", .participant_key = group.ana->participant_key()});
  EXPECT_EQ(back.participant_key(), group.ana->participant_key());
  EXPECT_NE(back.viewer_id(), group.ana->viewer_id());
  ASSERT_TRUE(group.ben->AwaitMarks(
      [&](const v1::Marks& marks) { return drawn_by(marks, back.viewer_id()) == 1; }));
  group.ana->Cancel();
  // A viewer without Ana's participant key owns none of the marks.
  Interacting other(group.service.stub(), group.created.viewer_key(), {.name = "Ana"});
  other.Send(Erases());
  v1::InteractRequest rename;
  rename.mutable_set_name()->set_name("Anna");
  other.Send(rename);
  ASSERT_TRUE(group.ben->AwaitPresence([&](const v1::Presence& presence) {
    const v1::Person* const person = Find(presence, other.viewer_id());
    return person != nullptr && person->name() == "Anna";
  })) << "it is not later than what was sent before";
  EXPECT_EQ(Interacting(group.service.stub(), group.created.viewer_key())
                .AwaitNewest(Response::kMarks)
                .marks()
                .marks_size(),
            2);
  back.Send(Erases());
  EXPECT_TRUE(group.ben->AwaitMarks([&](const v1::Marks& marks) {
    return marks.marks_size() == 1 && drawn_by(marks, group.presenter->viewer_id()) == 1;
  }));
}

TEST(InteractTest, WhoReconnectsSteersAgain) {
  Class group;  // control waits for the returning viewer longer than this test takes
  Interacting second(group.service.stub(), group.created.session_id(), Class::Named("Tablet"));
  ASSERT_GT(second.viewer_id(), 0U);
  const std::string key = group.presenter->participant_key();
  group.presenter->Cancel();
  ASSERT_TRUE(Class::SteersFor(*group.ana, 0)) << "not the other presenter";
  EXPECT_EQ(group.ana->AwaitNewest(Response::kPresence).presence().awaited().viewer_id(),
            group.presenter->viewer_id());
  Interacting back(group.service.stub(), group.created.session_id(), {.participant_key = key});
  EXPECT_TRUE(Class::SteersFor(*group.ana, back.viewer_id()));
  EXPECT_FALSE(group.ana->AwaitNewest(Response::kPresence).presence().has_awaited());
  EXPECT_EQ(back.AnswerCode(back.Send(SunTo(120.0F))), grpc::StatusCode::OK);
}

// The client has lost its network. It receives nothing, and its connection is never closed.
TEST(InteractTest, ALostConnectionIsReplacedByTheOneThatComesBack) {
  RunningTime time;
  Class group({}, With({&Timeouts::sign_of_life}, time));
  Interacting lost(group.service.stub(), group.created.viewer_key(),
                   {.name = "Eve", .hidden = true, .acknowledges = false, .answers_checks = false});
  group.presenter->Send(Gives(lost.viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ana, lost.viewer_id()));
  Interacting back(group.service.stub(), group.created.viewer_key(),
                   {.name = "Eve", .participant_key = lost.participant_key()});
  lost.AwaitNewest(Response::kCheckAlive);
  // The server learns a little later that the check was sent.
  ASSERT_TRUE(WaitFor([&] {
    time.Advance(kTimeout);
    const v1::Presence presence = group.ana->AwaitNewest(Response::kPresence).presence();
    return Find(presence, lost.viewer_id()) == nullptr;
  }));
  ASSERT_TRUE(Class::SteersFor(*group.ana, back.viewer_id()));
  EXPECT_TRUE(group.ana->AwaitPresence(
      [&](const v1::Presence& presence) { return Find(presence, lost.viewer_id()) == nullptr; }));
  const grpc::Status end = lost.End();
  EXPECT_EQ(end.error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(ReasonOf(end), "CONNECTION_REPLACED");
}

TEST(InteractTest, AClientThatKnowsNoChecksStaysUntilItEnds) {
  RunningTime time;
  Class group(
      {}, With({&Timeouts::sign_of_life, &Timeouts::sign_of_life_in_all, &Timeouts::answer}, time));
  Interacting old(group.service.stub(), group.created.viewer_key(),
                  {.name = "Eve", .hidden = true, .answers_checks = false, .is_old = true});
  group.presenter->Send(Gives(old.viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ana, old.viewer_id()));
  Interacting back(group.service.stub(), group.created.viewer_key(),
                   {.name = "Eve", .participant_key = old.participant_key()});
  ASSERT_GT(back.viewer_id(), 0U);
  ASSERT_TRUE(group.RosterSees(time, 4 * kTimeout));
  EXPECT_EQ(old.AnswerCode(old.Send(SunTo(120.0F))), grpc::StatusCode::OK);
  old.Cancel();
  EXPECT_TRUE(Class::SteersFor(*group.ana, back.viewer_id()));
}

// The duplicated tab has a copy of the key of the tab that stays open.
TEST(InteractTest, ADuplicatedTabTakesNothingFromTheOtherOne) {
  RunningTime time;
  Class group(
      {}, With({&Timeouts::sign_of_life, &Timeouts::sign_of_life_in_all, &Timeouts::answer}, time));
  Interacting tab(group.service.stub(), group.created.session_id(),
                  {.participant_key = group.presenter->participant_key()});
  ASSERT_GT(tab.viewer_id(), 0U);
  group.presenter->AwaitNewest(Response::kCheckAlive);
  // The tab answers the connection check before the time is advanced. A request that it sends later
  // arrives after this answer.
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send(SunTo(125.0F))),
            grpc::StatusCode::OK);
  ASSERT_TRUE(group.RosterSees(time, 2 * kTimeout));
  EXPECT_EQ(tab.AnswerCode(tab.Send(SunTo(120.0F))), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send(SunTo(130.0F))),
            grpc::StatusCode::OK);
}

TEST(InteractTest, AParticipantKeyThatNobodyGaveIsRefused) {
  Class group;
  for (const std::string key : {"0123", "0123456789abcdef0123456789abcdeg"}) {
    Interacting person(group.service.stub(), group.created.viewer_key(), {.participant_key = key});
    const grpc::Status end = person.End();
    EXPECT_EQ(end.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << key;
    EXPECT_EQ(ReasonOf(end), "KEY_MALFORMED");
    EXPECT_THAT(end.error_message(), HasSubstr("join.participant_key"));
  }
}

// Number of threads of the executor that finds the places of marks.
constexpr int kExecutorThreads = 4;

TEST(InteractTest, AMarkWaitsUntilTheLastOneHasItsPlace) {
  Class group;
  ASSERT_TRUE(group.ana->AwaitFrame(1));
  const std::uint32_t shown = group.ana->AwaitScene(1).time_index();
  group.service.store->reading.Close();
  std::vector<std::thread> readers;
  for (int i = 0; i < kExecutorThreads; ++i) {
    readers.emplace_back([&] {
      v1::DescribeStormRequest request;
      request.set_storm_id("anvil");
      request.set_time_index(shown == 0 ? 1 : 0);
      v1::DescribeStormResponse response;
      Call(group.service.stub(), &Stub::DescribeStorm, request, &response);
    });
  }
  EXPECT_TRUE(group.service.store->reading.AwaitWaiting(kExecutorThreads));
  group.presenter->Send(Draws());
  const v1::Refused refused = group.presenter->Answer(group.presenter->Send(Draws())).refused();
  EXPECT_EQ(refused.status().code(), static_cast<int>(grpc::StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_EQ(ReasonOf(refused.status()), "MARKS_TOO_FAST");
  EXPECT_GT(RetryAfterOf(refused.status()), std::chrono::milliseconds(0));
  group.service.store->reading.Open();
  for (std::thread& reader : readers) reader.join();
  ASSERT_TRUE(
      group.ana->AwaitMarks([](const v1::Marks& marks) { return marks.marks_size() == 1; }));
  group.presenter->Send(Draws());
  EXPECT_TRUE(
      group.ana->AwaitMarks([](const v1::Marks& marks) { return marks.marks_size() == 2; }));
}

// The server queues answers for a client that does not read them, and limits their number. Beyond
// the limit it reads no further request of this client.
TEST(InteractTest, WhoReadsNoAnswersIsNotHeardAnyMore) {
  service::ServerOptions options = Patient();
  options.address = "127.0.0.1:0";
  options.access_control = std::make_shared<access::AccessControl>(
      access::TrustEverybody(), std::make_shared<access::Audit>([](const std::string&) {}),
      access::QuotaLimits{.requests_per_second = 0.0});
  Class group({}, options);
  // The client's connection buffers only 64 KiB, which the client does not read.
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 1 << 16);
  const auto stub = v1::ThunderheadService::NewStub(
      grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(group.service.server().Port()),
                                grpc::InsecureChannelCredentials(), arguments));
  grpc::ClientContext context;
  const auto call = stub->Interact(&context);
  v1::InteractRequest join;
  join.mutable_join()->set_session_key(group.created.viewer_key());
  join.mutable_join()->set_name("Deaf");
  join.mutable_join()->mutable_window()->set_hidden(true);
  ASSERT_TRUE(call->Write(join));
  // All answers together are larger than this buffer, and all requests together are smaller.
  constexpr std::uint64_t kRequests = 1500;
  for (std::uint64_t i = 1; i <= kRequests; ++i) {
    v1::InteractRequest refused = Takes();
    refused.set_request_id(i);
    ASSERT_TRUE(call->Write(refused));
  }
  v1::InteractRequest rename;
  rename.mutable_set_name()->set_name("Heard");
  ASSERT_TRUE(call->Write(rename));
  const auto is_called = [&](const std::string& name) {
    return [name](const v1::Presence& presence) {
      return std::ranges::any_of(presence.people(),
                                 [&](const v1::Person& person) { return person.name() == name; });
    };
  };
  ASSERT_TRUE(group.ana->AwaitPresence(is_called("Deaf")));
  // The server has stopped reading this client's requests once it serves others but counts no
  // further request of this one.
  const auto heard = [] { return telemetry::Counted().refusals.Of("NOT_PRESENTER").Value(); };
  std::uint64_t before = 0;
  ASSERT_TRUE(WaitFor([&] {
    const bool same = std::exchange(before, heard()) == heard();
    for (int i = 0; i < 20; ++i) group.ben->AnswerCode(group.ben->Send(SunTo(120.0F)));
    return same && before == heard();
  }));
  EXPECT_TRUE(is_called("Deaf")(group.ana->AwaitNewest(Response::kPresence).presence()));
  std::uint64_t answers = 0;
  v1::InteractResponse response;
  while (answers < kRequests && call->Read(&response)) answers += response.has_refused() ? 1 : 0;
  EXPECT_EQ(answers, kRequests) << "none is lost";
  EXPECT_TRUE(group.ana->AwaitPresence(is_called("Heard")));
  context.TryCancel();
  while (call->Read(&response)) {
  }
  EXPECT_EQ(call->Finish().error_code(), grpc::StatusCode::CANCELLED);
}

TEST(InteractTest, APresenterWhoReloadsHasControlAgain) {
  Class group;  // control waits for the returning viewer longer than this test takes
  group.presenter->Cancel();
  ASSERT_TRUE(group.ana->AwaitPresence(
      [](const v1::Presence& presence) { return presence.presenter_away(); }));
  Interacting back(group.service.stub(), group.created.session_id(),
                   {.name = "Teacher", .participant_key = group.presenter->participant_key()});
  ASSERT_TRUE(Class::SteersFor(*group.ana, back.viewer_id()));
  EXPECT_EQ(back.AnswerCode(back.Send(SunTo(120.0F))), grpc::StatusCode::OK);
}

TEST(InteractTest, HiddenWindowsGetNoFrames) {
  Class group;
  Interacting hidden(group.service.stub(), group.created.viewer_key(), {.hidden = true});
  ASSERT_GT(hidden.viewer_id(), 0U);
  group.presenter->Send(SunTo(120.0F));
  ASSERT_TRUE(group.ana->AwaitFrame(2));
  for (const Response& message : hidden.All()) EXPECT_FALSE(message.has_frame());
  v1::InteractRequest shown;
  shown.mutable_window()->set_hidden(false);
  hidden.Send(shown);
  EXPECT_TRUE(hidden.AwaitFrame(2));
}

TEST(InteractTest, OldCallsHaveTheRightsOfTheirKey) {
  Class group;
  v1::UpdateSceneRequest update;
  *update.mutable_scene() = SmallScene();
  v1::UpdateSceneResponse updated;
  const auto code = [&](const std::string& key) {
    update.set_session_id(key);
    return Call(group.service.stub(), &Stub::UpdateScene, update, &updated).error_code();
  };
  EXPECT_EQ(code(group.created.viewer_key()), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(code(group.created.session_id()), grpc::StatusCode::OK);
  group.presenter->Send(Gives(group.ana->viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ana, group.ana->viewer_id()));
  EXPECT_EQ(code(group.created.session_id()), grpc::StatusCode::PERMISSION_DENIED);
  update.set_expected_revision(1);
  group.presenter->Send(Takes());
  ASSERT_TRUE(Class::SteersFor(*group.ana, group.presenter->viewer_id()));
  EXPECT_EQ(code(group.created.session_id()), grpc::StatusCode::ABORTED);
  v1::CloseSessionRequest close;
  close.set_session_id(group.created.viewer_key());
  v1::CloseSessionResponse closed;
  EXPECT_EQ(Call(group.service.stub(), &Stub::CloseSession, close, &closed).error_code(),
            grpc::StatusCode::PERMISSION_DENIED);
}

TEST(InteractTest, ClosingSaysSoBeforeItEndsTheCall) {
  Class group;
  v1::CloseSessionRequest close;
  close.set_session_id(group.created.session_id());
  v1::CloseSessionResponse closed;
  ASSERT_TRUE(Call(group.service.stub(), &Stub::CloseSession, close, &closed).ok());
  EXPECT_EQ(group.ana->End().error_code(), grpc::StatusCode::NOT_FOUND);
  const Interacting::Messages messages = group.ana->All();
  ASSERT_TRUE(messages.back().has_end());
  EXPECT_EQ(messages.back().end().reason(), v1::End::REASON_CLOSED);
  EXPECT_FALSE(messages.back().end().has_retry_after_ms());
}

TEST(InteractTest, AServerThatStopsSaysWhenToComeBack) {
  Class group;
  group.service.server().Shutdown();
  EXPECT_EQ(group.ana->End().error_code(), grpc::StatusCode::UNAVAILABLE);
  const Interacting::Messages messages = group.ana->All();
  ASSERT_TRUE(messages.back().has_end());
  EXPECT_EQ(messages.back().end().reason(), v1::End::REASON_SERVER_STOPS);
  EXPECT_TRUE(messages.back().end().has_retry_after_ms());
}

TEST(InteractTest, APointerGoesWithTheRightToPoint) {
  Class group;
  group.presenter->Send(Gives(group.ana->viewer_id()));
  ASSERT_TRUE(Class::SteersFor(*group.ana, group.ana->viewer_id()));
  v1::InteractRequest point;
  *point.mutable_point()->mutable_ray() = RayDown();
  group.ana->Send(point);
  const auto pointers_are = [&](int count) {
    return group.ben->Await([&](const Interacting::Messages& messages) {
      const auto newest = std::find_if(messages.rbegin(), messages.rend(),
                                       [](const auto& message) { return message.has_pointers(); });
      return newest != messages.rend() && newest->pointers().pointers_size() == count;
    });
  };
  ASSERT_TRUE(pointers_are(1));
  group.presenter->Send(Takes());
  EXPECT_TRUE(pointers_are(0));
}

TEST(InteractTest, FieldsThatNobodyKnowsAreNotPassedOn) {
  Class group;
  v1::InteractRequest request = SunTo(120.0F);
  v1::Scene& scene = *request.mutable_update_scene()->mutable_scene();
  scene.GetReflection()->MutableUnknownFields(&scene)->AddLengthDelimited(
      10'000, std::string(500'000, 'x'));
  ASSERT_EQ(group.presenter->AnswerCode(group.presenter->Send(request)), grpc::StatusCode::OK);
  EXPECT_LT(group.ana->AwaitScene(2).ByteSizeLong(), 10'000U);
}

TEST(InteractTest, AnOwnViewOfTheReferenceIsDrawnByTheDefaultTechnique) {
  Class group;
  v1::InteractRequest request = SunTo(120.0F);
  request.mutable_update_scene()->mutable_scene()->mutable_rendering()->mutable_reference();
  ASSERT_EQ(group.presenter->AnswerCode(group.presenter->Send(request)), grpc::StatusCode::OK);
  group.ana->Send(LooksFrom(90.0F));
  ASSERT_TRUE(group.ana->AwaitFrame(1, /*own_view=*/true));
  for (const Response& message : group.ana->All()) {
    if (!message.frame().own_view()) continue;
    EXPECT_EQ(message.frame().modelled().technique(), "light_volume");
  }
}

TEST(InteractTest, WhoLeavesIsGone) {
  Class group;
  group.ana->Leave();
  EXPECT_TRUE(group.ana->End().ok());
  EXPECT_TRUE(group.ben->AwaitPresence(
      [](const v1::Presence& presence) { return presence.people_size() == 2; }));
}

TEST(InteractTest, TheFirstMessageJoins) {
  FakeService service;
  grpc::ClientContext context;
  const auto call = service.stub().Interact(&context);
  v1::InteractRequest request;
  request.mutable_ask_control();
  ASSERT_TRUE(call->Write(request));
  v1::InteractResponse response;
  EXPECT_FALSE(call->Read(&response));
  const grpc::Status status = call->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("it must be the first message"));
  Interacting nobody(service.stub(), "0123");
  EXPECT_EQ(nobody.End().error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST(InteractTest, BadMessagesAreRefusedAndTheCallGoesOn) {
  Class group;
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send({})),
            grpc::StatusCode::INVALID_ARGUMENT);
  v1::InteractRequest mark;
  mark.mutable_add_mark()->add_rays();
  const auto refused = group.presenter->Answer(group.presenter->Send(mark)).refused();
  EXPECT_THAT(refused.status().message(), HasSubstr("add_mark.rays[0].direction has length 0"));
  v1::InteractRequest sun = SunTo(120.0F);
  sun.mutable_update_scene()->mutable_scene()->mutable_sun()->set_elevation_deg(400.0F);
  EXPECT_THAT(group.presenter->Answer(group.presenter->Send(sun)).refused().status().message(),
              HasSubstr("update_scene.scene.sun.elevation_deg is 400"));
  EXPECT_EQ(group.presenter->AnswerCode(group.presenter->Send(SunTo(120.0F))),
            grpc::StatusCode::OK);
}

TEST(InteractTest, NamesArePlainText) {
  FakeService service;
  const auto created = Create(service);
  Interacting person(service.stub(), created.viewer_key(),
                     {.name = " \x01" + std::string(50, 'a') + "\n"});
  ASSERT_TRUE(person.AwaitPresence([](const v1::Presence& presence) {
    return presence.people_size() == 1 && presence.people(0).name() == std::string(38, 'a');
  }));
  v1::InteractRequest rename;
  // Names lose characters that change the direction of text, and invisible ones, which could make
  // one name look like another (base::Printable).
  for (const auto& [name, shown] :
       {std::pair("Zoë", "Zoë"),
        {"A\u202Enna\u200B", "A nna"},
        {"A\u200Fn\u061Cna\u200D", "A n na"},
        {"A\U000E0042nna\u3164", "A nna"},
        {"\u0646\u200C\u0627 \U0001F329", "\u0646\u200C\u0627 \U0001F329"}}) {
    rename.mutable_set_name()->set_name(name);
    person.Send(rename);
    EXPECT_TRUE(person.AwaitPresence([expected = shown](const v1::Presence& presence) {
      return presence.people(0).name() == expected;
    })) << shown;
  }
}

TEST(InteractTest, AViewerWhoAcknowledgesNothingHoldsUpNobody) {
  Class group;
  Interacting stalled(group.service.stub(), group.created.viewer_key(), {.acknowledges = false});
  ASSERT_TRUE(stalled.AwaitFrame(1));
  for (int i = 0; i < 8; ++i) {
    const float azimuth_deg = 100.0F + static_cast<float>(i);
    const Response answer = group.presenter->Answer(group.presenter->Send(SunTo(azimuth_deg)));
    ASSERT_TRUE(group.ana->AwaitFrame(answer.scene_taken().scene_revision()));
  }
  const Interacting::Messages messages = stalled.All();
  EXPECT_LE(std::ranges::count_if(messages, [](const auto& m) { return m.has_frame(); }), 2);
}

}  // namespace
}  // namespace thunderhead::testing
