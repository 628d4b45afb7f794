// Tests of a session against the fake service: joining, editing, control and reconnecting.
#include "thunderhead_client/session.h"

#include <algorithm>
#include <fstream>
#include <future>

#include "client-cpp/tests/fake_service.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "thunderhead_client/pose.h"

namespace thunderhead::client::testing {
namespace {

using Requests = FakeService::Requests;

class Listener final : public SessionListener {
 public:
  void Changed() override {
    const std::lock_guard lock(mutex_);
    ++changes_;
    changed_.notify_all();
  }
  void StreamBegan() override {}
  void Received(v1::Frame frame, std::size_t /*bytes*/) override {
    const std::lock_guard lock(mutex_);
    frames.push_back(std::move(frame));
    changed_.notify_all();
  }
  void SceneTaken(std::uint64_t revision, std::chrono::steady_clock::time_point) override {
    const std::lock_guard lock(mutex_);
    taken.push_back(revision);
  }
  bool Await(const std::function<bool()>& wanted) {
    std::unique_lock lock(mutex_);
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!wanted()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      changed_.wait_for(lock, std::chrono::milliseconds(20));
    }
    return true;
  }

  std::vector<v1::Frame> frames;
  std::vector<std::uint64_t> taken;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int changes_ = 0;
};

class SessionTest : public ::testing::Test {
 protected:
  void Begin(SessionOptions options = {}) {
    session = std::make_unique<Session>(service.Connect(), std::move(options), listener);
    ASSERT_TRUE(listener.Await([&] { return session->State().link == Link::kLive; }));
  }
  // Makes the client steer at revision 1.
  void Steer() {
    Begin();
    service.SendScene({}, 1);
    service.SendPresence(FakeService::kClient);
    ASSERT_TRUE(listener.Await([&] { return session->State().Steers(); }));
  }
  static long Count(const Requests& requests, v1::InteractRequest::MessageCase part) {
    return std::count_if(requests.begin(), requests.end(),
                         [=](const auto& each) { return each.message_case() == part; });
  }
  bool AwaitCount(v1::InteractRequest::MessageCase part, long count) {
    return service.Await([=](const Requests& requests) { return Count(requests, part) >= count; });
  }
  v1::InteractRequest Newest(v1::InteractRequest::MessageCase part) {
    v1::InteractRequest newest;
    for (const auto& each : service.All()) {
      if (each.message_case() == part) newest = each;
    }
    return newest;
  }
  // Returns the maximum number of cameras or pointers that the client may have sent since `began`.
  // The first is sent at once, then 30 a second.
  static long MostSince(std::chrono::steady_clock::time_point began) {
    const std::chrono::duration<double> past = std::chrono::steady_clock::now() - began;
    return 1 + static_cast<long>(past.count() * 30.0);
  }
  static SceneSync::Edit SunTo(float azimuth_deg) {
    return [=](v1::Scene& scene) { scene.mutable_sun()->set_azimuth_deg(azimuth_deg); };
  }

  FakeService service;
  Listener listener;
  std::unique_ptr<Session> session;
};

TEST_F(SessionTest, OpensASessionAndTakesControlOfIt) {
  SessionOptions options;
  options.name = "Wall";
  options.codecs = {v1::CODEC_VP9};
  Begin(options);
  EXPECT_EQ(service.opened(), 1);
  const v1::Join join = service.All().front().join();
  EXPECT_EQ(join.session_key(), FakeService::kPresenterKey);
  EXPECT_EQ(join.name(), "Wall");
  EXPECT_EQ(join.codecs(1), v1::CODEC_VP9);
  service.SendPresence(0);
  EXPECT_TRUE(AwaitCount(v1::InteractRequest::kTakeControl, 1));
}

// A client that joins hidden and becomes visible meanwhile must report this, because the server
// sends frames only to visible viewers.
TEST_F(SessionTest, AWindowToldWhileJoiningReachesTheServer) {
  SessionOptions options;
  options.window.set_hidden(true);
  session = std::make_unique<Session>(service.Connect(), options, listener);
  ASSERT_TRUE(service.Await([](const Requests& requests) { return !requests.empty(); }));
  v1::Window visible;
  visible.set_width_px(640);
  session->SetWindow(visible);
  ASSERT_TRUE(AwaitCount(v1::InteractRequest::kWindow, 1));
  EXPECT_EQ(Newest(v1::InteractRequest::kWindow).window().width_px(), 640U);
}

TEST_F(SessionTest, JoinsBySomebodyElsesKeyWithoutOpening) {
  SessionOptions options;
  options.key = FakeService::kViewerKey;
  Begin(options);
  EXPECT_EQ(service.opened(), 0);
  EXPECT_EQ(session->State().role, v1::ROLE_VIEWER);
  EXPECT_TRUE(session->State().presenter_key.empty());
  EXPECT_FALSE(session->Edit(SunTo(90.0F)));
}

TEST_F(SessionTest, EditsAreSentWithTheRevisionThatTheyWereMadeTo) {
  Steer();
  ASSERT_TRUE(session->Edit(SunTo(90.0F)));
  ASSERT_TRUE(AwaitCount(v1::InteractRequest::kUpdateScene, 1));
  const v1::SceneUpdate update = Newest(v1::InteractRequest::kUpdateScene).update_scene();
  EXPECT_EQ(update.expected_revision(), 1U);
  EXPECT_EQ(update.scene().sun().azimuth_deg(), 90.0F);
  EXPECT_TRUE(listener.Await([&] { return session->State().scene_revision == 2; }));
}

// Sends one edit, whose response is then pending while another viewer takes control.
class TakeoverTest : public SessionTest {
 protected:
  void SetUp() override {
    service.answers_scenes = false;
    Steer();
    ASSERT_TRUE(session->Edit(SunTo(90.0F)));
    ASSERT_TRUE(AwaitCount(v1::InteractRequest::kUpdateScene, 1));
    request_id = Newest(v1::InteractRequest::kUpdateScene).request_id();
    service.SendPresence(3, {3});
    ASSERT_TRUE(listener.Await([&] { return !session->State().Steers(); }));
    EXPECT_EQ(session->State().scene.sun().azimuth_deg(), 90.0F);
    EXPECT_EQ(session->State().notice, "");
  }

  std::uint64_t request_id = 0;
};

TEST_F(TakeoverTest, AnEditThatWasAcceptedBeforeStays) {
  v1::InteractResponse taken;
  taken.mutable_scene_taken()->set_request_id(request_id);
  taken.mutable_scene_taken()->set_scene_revision(2);
  service.Send(taken);
  ASSERT_TRUE(listener.Await([&] { return session->State().scene_revision == 2; }));
  EXPECT_EQ(session->State().scene.sun().azimuth_deg(), 90.0F);
  EXPECT_EQ(session->State().notice, "");
}

TEST_F(TakeoverTest, AnEditThatCameTooLateIsDiscardedWithANotice) {
  v1::InteractResponse stale;
  stale.mutable_refused()->set_request_id(request_id);
  stale.mutable_refused()->mutable_status()->set_code(grpc::StatusCode::ABORTED);
  service.Send(stale);
  ASSERT_TRUE(listener.Await([&] { return !session->State().notice.empty(); }));
  EXPECT_THAT(session->State().notice, ::testing::HasSubstr("Your last change was not made"));
  EXPECT_FALSE(session->State().scene.sun().has_azimuth_deg());
}

TEST_F(SessionTest, ComesBackToTheSameSessionWhenTheServerRestarts) {
  Steer();
  service.Stop();
  ASSERT_TRUE(listener.Await([&] { return session->State().link == Link::kLost; }));
  service.Start();
  ASSERT_TRUE(listener.Await([&] { return session->State().joined_count == 2; }));
  EXPECT_EQ(service.opened(), 1);
  const v1::Join join = Newest(v1::InteractRequest::kJoin).join();
  EXPECT_EQ(join.session_key(), FakeService::kPresenterKey);
  EXPECT_EQ(join.participant_key(), "participant-key");
  // The client steered, so it takes control back from its lost connection, which the server may
  // still consider alive.
  service.SendPresence(0);
  EXPECT_TRUE(AwaitCount(v1::InteractRequest::kTakeControl, 1));
}

// A client that loses its connection while it steers and while its last edit is unanswered.
class ResumptionTest : public SessionTest {
 protected:
  static constexpr std::uint64_t kColleague = 3;
  static constexpr std::uint64_t kClientAgain = FakeService::kClient + 5;
  static constexpr float kEdited_deg = 90.0F;

  void LoseConnection(const std::string& key, const std::vector<std::uint64_t>& others = {}) {
    service.answers_scenes = false;
    SessionOptions options;
    options.key = key;
    Begin(options);
    service.SendScene({}, 1);
    service.SendPresence(FakeService::kClient, others);
    ASSERT_TRUE(listener.Await([&] { return session->State().Steers(); }));
    ASSERT_TRUE(session->Edit(SunTo(kEdited_deg)));
    ASSERT_TRUE(AwaitCount(v1::InteractRequest::kUpdateScene, 1));
    service.client = kClientAgain;
    service.answers_scenes = true;
    service.EndCall(grpc::Status(grpc::StatusCode::UNAVAILABLE, "lost"));
    ASSERT_TRUE(listener.Await([&] { return session->State().joined_count == 2; }));
    service.SendScene({}, 1);
  }
  // Sends a presence message that says who is in control, and waits until the client has processed
  // it.
  void Tell(std::uint64_t steering, const std::vector<std::uint64_t>& others = {}) {
    service.SendPresence(steering, others);
    ASSERT_TRUE(listener.Await([&] {
      const SessionState state = session->State();
      return state.presence.people_size() == static_cast<int>(1 + others.size()) &&
             state.presence.steering_viewer_id() == steering;
    }));
  }
  // Checks that the client requests control only once after it has joined again. A second presence
  // message must not cause another request, because the server may have sent that message before it
  // received the first request.
  void TakesControlAgainFrom(std::uint64_t steering) {
    Tell(steering, {FakeService::kClient});
    Tell(steering, {FakeService::kClient, kColleague});
    EXPECT_TRUE(KeepsEdit());
    Tell(kClientAgain);
    EXPECT_TRUE(EditIsSentAgain());
    EXPECT_EQ(Count(service.All(), v1::InteractRequest::kTakeControl), 1);
  }
  bool KeepsEdit() const { return session->State().scene.sun().azimuth_deg() == kEdited_deg; }
  bool EditIsSentAgain() { return AwaitCount(v1::InteractRequest::kUpdateScene, 2); }
};

TEST_F(ResumptionTest, AViewersEditIsKeptWhileTheLostConnectionSteers) {
  LoseConnection(FakeService::kViewerKey);
  Tell(FakeService::kClient, {FakeService::kClient});
  Tell(0);
  EXPECT_TRUE(KeepsEdit());
  EXPECT_EQ(Count(service.All(), v1::InteractRequest::kTakeControl), 0);
  Tell(kClientAgain);
  EXPECT_TRUE(EditIsSentAgain());
  EXPECT_EQ(Newest(v1::InteractRequest::kUpdateScene).update_scene().scene().sun().azimuth_deg(),
            kEdited_deg);
}

TEST_F(ResumptionTest, APresenterTakesControlAgainFromItsLostConnection) {
  LoseConnection(FakeService::kPresenterKey);
  TakesControlAgainFrom(FakeService::kClient);
}

TEST_F(ResumptionTest, AColleagueWhoWasThereAndTookControlKeepsIt) {
  LoseConnection(FakeService::kPresenterKey, {kColleague});
  Tell(kColleague, {kColleague});
  EXPECT_FALSE(KeepsEdit());
  session->SetName("A later request");
  ASSERT_TRUE(AwaitCount(v1::InteractRequest::kSetName, 1));
  EXPECT_EQ(Count(service.All(), v1::InteractRequest::kTakeControl), 0);
}

TEST_F(SessionTest, AnswersTheServerThatAsksWhetherItIsThere) {
  Steer();
  v1::InteractResponse asks;
  asks.mutable_check_alive();
  service.Send(asks);
  EXPECT_TRUE(AwaitCount(v1::InteractRequest::kAlive, 1));
}

TEST_F(SessionTest, AnEditThatHadNoAnswerIsSentAgainAfterwards) {
  service.answers_scenes = false;
  Steer();
  session->Edit(SunTo(90.0F));
  ASSERT_TRUE(AwaitCount(v1::InteractRequest::kUpdateScene, 1));
  service.EndCall(grpc::Status(grpc::StatusCode::UNAVAILABLE, "restart"));
  ASSERT_TRUE(listener.Await([&] { return session->State().joined_count == 2; }));
  service.answers_scenes = true;
  service.SendScene({}, 9);
  service.SendPresence(FakeService::kClient);
  ASSERT_TRUE(AwaitCount(v1::InteractRequest::kUpdateScene, 2));
  EXPECT_EQ(Newest(v1::InteractRequest::kUpdateScene).update_scene().expected_revision(), 9U);
}

TEST_F(SessionTest, OpensANewSessionWhenTheServerHasLostItsOwn) {
  Steer();
  service.forgets_sessions = true;
  service.EndCall(grpc::Status::OK);
  ASSERT_TRUE(listener.Await([&] { return service.opened() == 2; }));
  EXPECT_TRUE(listener.Await([&] { return session->State().joined_count == 2; }));
}

TEST_F(SessionTest, SaysThatTheServerHadLostTheSession) {
  Steer();
  service.forgets_sessions = true;
  service.EndCall(grpc::Status::OK);
  ASSERT_TRUE(listener.Await([&] { return session->State().joined_count == 2; }));
  EXPECT_EQ(session->State().notice,
            "The server had lost the session; this is a new one with the same scene.");
}

TEST_F(SessionTest, SaysWhyASessionEndedThatItReplaces) {
  SessionOptions options;
  options.never_gives_up = true;
  Begin(std::move(options));
  v1::InteractResponse response;
  response.mutable_end()->set_message("the session was closed");
  service.Send(response);
  service.EndCall(grpc::Status::OK);
  ASSERT_TRUE(listener.Await([&] { return session->State().joined_count == 2; }));
  EXPECT_EQ(session->State().notice,
            "The last session has ended (the session was closed). This is a new one with the same "
            "scene.");
}

TEST_F(SessionTest, SaysThatItIsNotSaved) {
  service.durable = false;
  Steer();
  EXPECT_THAT(session->State().notice, ::testing::HasSubstr("is not saved"));
}

TEST_F(SessionTest, SaysNothingOfASessionThatIsSaved) {
  service.durable = true;
  Steer();
  EXPECT_EQ(session->State().notice, "");
}

TEST_F(SessionTest, BeginsAnewWhereTheStormIsGoneToo) {
  Steer();
  session->Edit([](v1::Scene& scene) { scene.set_storm_id("gone"); });
  ASSERT_TRUE(AwaitCount(v1::InteractRequest::kUpdateScene, 1));
  service.answer_opening = [](const v1::Scene& scene) {
    return scene.storm_id() == "gone"
               ? grpc::Status(grpc::StatusCode::NOT_FOUND, "no storm has the id 'gone'")
               : grpc::Status::OK;
  };
  service.forgets_sessions = true;
  service.EndCall(grpc::Status::OK);
  EXPECT_TRUE(listener.Await([&] { return session->State().joined_count == 2; }));
  EXPECT_THAT(session->State().notice, ::testing::HasSubstr("no storm has the id 'gone'"));
}

TEST_F(SessionTest, EndsWithoutWaitingForAServerThatHangs) {
  std::promise<void> asked;
  std::promise<void> over;
  service.answer_opening = [&](const v1::Scene&) {
    asked.set_value();
    over.get_future().wait();
    return grpc::Status::OK;
  };
  SessionOptions options;
  options.patience = kPatience;  // a destructor that waited so long would fail the test
  session = std::make_unique<Session>(service.Connect(), options, listener);
  asked.get_future().wait();
  const auto began = std::chrono::steady_clock::now();
  session.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - began, kPatience);
  over.set_value();
}

TEST_F(SessionTest, SomebodyElsesSessionThatEndedIsGone) {
  SessionOptions options;
  options.key = FakeService::kViewerKey;
  Begin(options);
  v1::InteractResponse end;
  end.mutable_end()->set_reason(v1::End::REASON_CLOSED);
  end.mutable_end()->set_message("closed by the presenter");
  service.Send(end);
  service.EndCall(grpc::Status::OK);
  ASSERT_TRUE(listener.Await([&] { return session->State().link == Link::kGone; }));
  EXPECT_EQ(session->State().reason, "closed by the presenter");
  EXPECT_EQ(service.opened(), 0);
  session->OpenAnother();
  ASSERT_TRUE(listener.Await([&] { return session->State().link == Link::kLive; }));
  EXPECT_EQ(service.opened(), 1);
}

TEST_F(SessionTest, WhoDoesNotSteerLooksAroundAndFollowsAgain) {
  Begin();
  service.SendPresence(3);
  ASSERT_TRUE(listener.Await([&] { return session->State().presence.steering_viewer_id() == 3; }));
  const auto began = std::chrono::steady_clock::now();
  EXPECT_TRUE(session->ShowCamera(HomeCamera(v1::Camera::kTopDown)));
  EXPECT_TRUE(AwaitCount(v1::InteractRequest::kDetach, 1));
  for (int i = 0; i < 100; ++i) session->ShowCamera(HomeCamera(v1::Camera::kSpotter));
  EXPECT_TRUE(AwaitCount(v1::InteractRequest::kMoveCamera, 1));
  session->Follow();
  EXPECT_TRUE(AwaitCount(v1::InteractRequest::kFollow, 1));
  EXPECT_LE(Count(service.All(), v1::InteractRequest::kMoveCamera), MostSince(began));
  EXPECT_FALSE(session->State().looks_around);
}

TEST_F(SessionTest, ShownFramesAreAcknowledged) {
  Begin();
  v1::InteractResponse response;
  response.mutable_frame()->set_sequence(41);
  service.Send(response);
  ASSERT_TRUE(listener.Await([&] { return !listener.frames.empty(); }));
  session->Shown(listener.frames.front());
  ASSERT_TRUE(AwaitCount(v1::InteractRequest::kAcknowledge, 1));
  EXPECT_EQ(Newest(v1::InteractRequest::kAcknowledge).acknowledge().sequence(), 41U);
}

TEST_F(SessionTest, PointersAreThinnedAndMarksAreNot) {
  Begin();
  service.SendPresence(FakeService::kClient);
  ASSERT_TRUE(listener.Await([&] { return session->State().MayMark(); }));
  v1::Ray ray;
  ray.mutable_direction()->set_x(1.0F);
  const auto began = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) session->Point(ray);
  for (int i = 0; i < 5; ++i) session->AddMark({ray, ray});
  EXPECT_TRUE(AwaitCount(v1::InteractRequest::kAddMark, 5));
  EXPECT_TRUE(AwaitCount(v1::InteractRequest::kPoint, 1));
  EXPECT_LE(Count(service.All(), v1::InteractRequest::kPoint), MostSince(began));
}

TEST_F(SessionTest, TheTokenIsShownAndReadAgainForEachCall) {
  const std::string path = ::testing::TempDir() + "token";
  std::ofstream(path) << "first\n";
  const std::string address = service.Connect()->address();
  auto connection = Connection::Open({address, "", path});
  ASSERT_TRUE(connection.ok()) << connection.status();
  session = std::make_unique<Session>(*connection, SessionOptions{}, listener);
  ASSERT_TRUE(listener.Await([&] { return session->State().link == Link::kLive; }));
  EXPECT_EQ(service.authorization(), "Bearer first");
  std::ofstream(path) << "second\n";
  service.EndCall(grpc::Status(grpc::StatusCode::UNAVAILABLE, ""));
  ASSERT_TRUE(listener.Await([&] { return session->State().joined_count == 2; }));
  EXPECT_EQ(service.authorization(), "Bearer second");
}

TEST(Connection, BadFilesAndAddressesAreNamed) {
  EXPECT_THAT(std::string(Connection::Open({"localhost", "", ""}).status().message()),
              ::testing::HasSubstr("'localhost' is not HOST:PORT"));
  EXPECT_THAT(std::string(Connection::Open({"a:1", "/no/ca.pem", ""}).status().message()),
              ::testing::HasSubstr("/no/ca.pem"));
  EXPECT_THAT(std::string(Connection::Open({"localhost:1", "", "/no/token"}).status().message()),
              ::testing::HasSubstr("/no/token"));
}

}  // namespace
}  // namespace thunderhead::client::testing
